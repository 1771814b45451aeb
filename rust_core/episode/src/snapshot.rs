//! Snapshots: a header that says what they belong to, then the state as plain data, bit for bit.

use hp_plant::error::{PlantError, PlantResult};
use serde::Serialize;
use serde::de::DeserializeOwned;

const MAGIC: [u8; 4] = *b"HPEP";

/// Version of the bytes; a change of any state's fields raises it.
pub const VERSION: u16 = 9;

/// Mark and version.
const PREAMBLE: usize = MAGIC.len() + 2;

/// With what the state belongs to and a sum over all that follows.
const HEADER: usize = PREAMBLE + 3 * 8;

/// What a snapshot belongs to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    /// Hash of the architectures.
    pub architectures: u64,
    /// Hash of settings and reward.
    pub settings: u64,
    /// The vehicles in words.
    pub vehicles: String,
}

/// Writes a value.
///
/// # Errors
/// The value cannot be written, which plain data always can.
pub fn pack(identity: &Identity, value: &impl Serialize) -> PlantResult<Vec<u8>> {
    let mut bytes = Vec::with_capacity(4096);
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&identity.architectures.to_le_bytes());
    bytes.extend_from_slice(&identity.settings.to_le_bytes());
    bytes.extend_from_slice(&[0; 8]);
    let mut bytes = postcard::to_extend(&(&identity.vehicles, value), bytes)
        .map_err(|error| refused(error.to_string()))?;
    let sum = hash([&bytes[..HEADER - 8], &bytes[HEADER..]]);
    bytes[HEADER - 8..HEADER].copy_from_slice(&sum.to_le_bytes());
    Ok(bytes)
}

/// Reads a value that [`pack`] wrote with the same identity.
///
/// # Errors
/// The bytes are no snapshot, of another version, of something else, or damaged.
pub fn unpack<T: DeserializeOwned>(identity: &Identity, bytes: &[u8]) -> PlantResult<T> {
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        return Err(refused(format!("{} bytes, too few", bytes.len())));
    };
    if header[..MAGIC.len()] != MAGIC {
        return Err(refused("of something else"));
    }
    let version = u16::from_le_bytes([header[4], header[5]]);
    if version != VERSION {
        return Err(refused(format!("of version {version}, not {VERSION}")));
    }
    let number = |place: usize| {
        let bytes = &header[PREAMBLE + 8 * place..PREAMBLE + 8 * (place + 1)];
        bytes.iter().rev().fold(0, |sum, &byte| (sum << 8) | u64::from(byte))
    };
    if number(2) != hash([&header[..HEADER - 8], body]) {
        return Err(refused("damaged: its bytes do not add up"));
    }
    let damaged = |error: postcard::Error| refused(format!("damaged ({error})"));
    let (vehicles, body): (String, _) = postcard::take_from_bytes(body).map_err(damaged)?;
    if number(0) != identity.architectures {
        return Err(refused(format!(
            "of an environment with {vehicles}, but this one has {}",
            identity.vehicles
        )));
    }
    if number(1) != identity.settings {
        return Err(refused("of an environment with other parameters, actions, observations or reward"));
    }
    match postcard::take_from_bytes(body).map_err(damaged)? {
        (value, []) => Ok(value),
        (_, rest) => Err(refused(format!("followed by {} bytes too many", rest.len()))),
    }
}

/// An error about a state.
pub(crate) fn refused(what: impl Into<String>) -> PlantError {
    PlantError::State {
        value: what.into(),
        allowed: "must be what get_state() of an environment with the same settings returned".into(),
    }
}

/// Hash of bytes (FNV-1a).
fn hash<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> u64 {
    let bytes = parts.into_iter().flatten();
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Hash of texts that identify parameters.
#[must_use]
pub fn fingerprint(texts: &[String]) -> u64 {
    hash(texts.iter().flat_map(|text| [text.as_bytes(), &[0]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Identity {
        Identity { architectures: 1, settings: 2, vehicles: "vehicle `one`".to_owned() }
    }

    #[test]
    fn whatever_byte_is_changed_is_found() {
        let bytes = pack(&identity(), &(1.5_f64, vec![3_u8; 40])).expect("plain data");
        assert_eq!(unpack::<(f64, Vec<u8>)>(&identity(), &bytes), Ok((1.5, vec![3; 40])));
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 4;
            let error = unpack::<(f64, Vec<u8>)>(&identity(), &damaged).expect_err("must be found");
            assert!(matches!(error, PlantError::State { .. }), "byte {place}: {error}");
        }
    }

    #[test]
    fn a_state_of_something_else_says_what_it_is_of() {
        let bytes = pack(&identity(), &7_u8).expect("plain data");
        let other = Identity { architectures: 9, vehicles: "vehicle `two`".to_owned(), ..identity() };
        let message = unpack::<u8>(&other, &bytes).expect_err("foreign").to_string();
        assert!(message.contains("with vehicle `one`, but this one has vehicle `two`"), "{message}");
        let other = Identity { settings: 9, ..identity() };
        assert!(unpack::<u8>(&other, &bytes).expect_err("foreign").to_string().contains("other parameters"));
    }
}
