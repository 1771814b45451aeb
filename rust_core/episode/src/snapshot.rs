//! Snapshots: a few bytes of header, then the state as plain data, bit for bit.

use hp_plant::error::{PlantError, PlantResult};
use serde::Serialize;
use serde::de::DeserializeOwned;

const MAGIC: [u8; 4] = *b"HPEP";

/// Version of the bytes; a change of any state's fields raises it.
pub const VERSION: u16 = 5;

const HEADER: usize = MAGIC.len() + 2 + 8;

/// Writes a value.
///
/// # Errors
/// The value cannot be written, which plain data always can.
pub fn pack(fingerprint: u64, value: &impl Serialize) -> PlantResult<Vec<u8>> {
    let mut bytes = Vec::with_capacity(4096);
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&fingerprint.to_le_bytes());
    postcard::to_extend(value, bytes).map_err(|error| refused(&error.to_string()))
}

/// Reads a value that [`pack`] wrote with the same fingerprint.
///
/// # Errors
/// The bytes are no snapshot, of another version, of other parameters, or damaged.
pub fn unpack<T: DeserializeOwned>(fingerprint: u64, bytes: &[u8]) -> PlantResult<T> {
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        return Err(refused(&format!("{} bytes, too few", bytes.len())));
    };
    if header[..4] != MAGIC {
        return Err(refused("of something else"));
    }
    let version = u16::from_le_bytes([header[4], header[5]]);
    if version != VERSION {
        return Err(refused(&format!("of version {version}, not {VERSION}")));
    }
    if header[6..] != fingerprint.to_le_bytes() {
        return Err(refused("of an environment with other parameters, actions, observations or reward"));
    }
    match postcard::take_from_bytes(body) {
        Ok((value, [])) => Ok(value),
        Ok((_, rest)) => Err(refused(&format!("followed by {} bytes too many", rest.len()))),
        Err(error) => Err(refused(&format!("damaged ({error})"))),
    }
}

fn refused(what: &str) -> PlantError {
    PlantError::InvalidArgument {
        what: "state".into(),
        value: what.to_owned(),
        allowed: "must be what get_state() of an environment with the same settings returned".into(),
    }
}

/// Hash of texts that identify parameters (FNV-1a).
#[must_use]
pub fn fingerprint(texts: &[String]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in texts.iter().flat_map(|text| text.bytes().chain([0])) {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    hash
}
