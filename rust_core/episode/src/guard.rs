//! What a panic leaves: an error that says where, and a value that is not used until it was begun anew.
//!
//! The one place at which panics end, so that none unwinds into Python.

use hp_plant::error::{PlantError, PlantResult};
use std::any::Any;
use std::backtrace::Backtrace;
use std::ops::Deref;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::{Mutex, PoisonError};

/// Crates whose functions tell where a panic was.
const CRATES: [&str; 2] = ["hp_plant::", "hp_trip::"];

/// Place and words of the last panic of any thread.
static LAST: Mutex<Option<String>> = Mutex::new(None);

/// Keeps the place of panics for their errors; writes them to the error stream too if `RUST_BACKTRACE` is `full`.
pub fn note_panics() {
    let usual = take_hook();
    set_hook(Box::new(move |panic| {
        let place = panic.location().map(|place| format!(" at {}:{}", place.file(), place.line()));
        let told = format!("{}{}{}", words(panic.payload()), place.unwrap_or_default(), within());
        *LAST.lock().unwrap_or_else(PoisonError::into_inner) = Some(told);
        if std::env::var_os("RUST_BACKTRACE").is_some_and(|value| value == "full") {
            usual(panic);
        }
    }));
}

/// Function of the simulation that something else was called from: a panic's own place is often one of the library.
fn within() -> String {
    let trace = Backtrace::force_capture().to_string();
    let own = |name: &&str| CRATES.iter().any(|krate| name.starts_with(krate));
    let names = trace.lines().filter_map(|line| line.split_once(": ")).map(|(_, name)| name.trim());
    names.into_iter().find(own).map(|name| format!(", in {name}")).unwrap_or_default()
}

fn words(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no words")
}

/// Does some work; a panic is an error.
///
/// # Errors
/// Those of the work, and [`PlantError::Internal`] where it panicked.
pub fn caught<T>(work: impl FnOnce() -> PlantResult<T>) -> PlantResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| Err(internal(&*payload)))
}

/// Does some work that cannot fail; a panic is an error.
///
/// # Errors
/// [`PlantError::Internal`] where it panicked.
pub fn done<T>(work: impl FnOnce() -> T) -> PlantResult<T> {
    caught(|| Ok(work()))
}

#[cold]
fn internal(payload: &(dyn Any + Send)) -> PlantError {
    let noted = LAST.lock().unwrap_or_else(PoisonError::into_inner).take();
    PlantError::Internal { message: noted.unwrap_or_else(|| words(payload).to_owned()) }
}

/// A value that is refused after a panic, until it was begun anew. It can be looked at freely and changed by the functions
/// below only.
#[derive(Debug)]
pub struct Guarded<T> {
    value: T,
    broken: bool,
}

impl<T> Deref for Guarded<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> Guarded<T> {
    /// A sound value.
    pub fn new(value: T) -> Self {
        Self { value, broken: false }
    }

    /// Whether a panic left the value unfit for use.
    ///
    /// # Errors
    /// [`PlantError::Internal`] if so.
    #[inline]
    pub fn require_sound(&self) -> PlantResult<()> {
        if self.broken { Err(broken()) } else { Ok(()) }
    }

    /// Changes the value.
    ///
    /// # Errors
    /// Those of the work; [`PlantError::Internal`] if it panicked, or if something has before.
    #[inline]
    pub fn change<R>(&mut self, work: impl FnOnce(&mut T) -> PlantResult<R>) -> PlantResult<R> {
        self.require_sound()?;
        // Only what returns leaves it sound.
        self.broken = true;
        let done = catch_unwind(AssertUnwindSafe(|| work(&mut self.value)));
        self.broken = done.is_err();
        done.unwrap_or_else(|payload| Err(internal(&*payload)))
    }

    /// Changes the value by what cannot fail.
    ///
    /// # Errors
    /// [`PlantError::Internal`] if it panicked, or if something has before.
    #[inline]
    pub fn alter<R>(&mut self, work: impl FnOnce(&mut T) -> R) -> PlantResult<R> {
        self.change(|value| Ok(work(value)))
    }

    /// Begins anew, after which the value is sound.
    ///
    /// # Errors
    /// Those of the work, after which it is as sound as before; [`PlantError::Internal`] if it panicked.
    pub fn begin<R>(&mut self, work: impl FnOnce(&mut T) -> PlantResult<R>) -> PlantResult<R> {
        let before = std::mem::replace(&mut self.broken, true);
        let done = caught(|| work(&mut self.value));
        self.broken = match &done {
            Ok(_) => false,
            Err(PlantError::Internal { .. }) => true,
            Err(_) => before,
        };
        done
    }
}

#[cold]
fn broken() -> PlantError {
    PlantError::Internal {
        message: "an earlier one left this unfit for use: reset all of it, restore a state of all of it, or make another"
            .to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[allow(clippy::panic_in_result_fn)]
    fn breaks(value: &mut Vec<u8>) -> PlantResult<()> {
        value.push(9);
        let place = value.len() + 5;
        // A real one: beyond the end.
        value[place] = 0;
        Ok(())
    }

    #[test]
    fn after_a_panic_a_value_is_refused_until_it_is_begun_anew() {
        let mut guarded = Guarded::new(vec![1_u8]);
        let error = guarded.change(breaks).expect_err("panicked");
        assert!(
            matches!(&error, PlantError::Internal { message } if message.contains("index out of bounds")),
            "{error}"
        );
        let refused = guarded.change(|value| Ok(value.len())).expect_err("broken");
        assert!(refused.to_string().contains("reset all of it"), "{refused}");
        assert!(guarded.require_sound().is_err());
        // What fails or panics itself heals nothing.
        let told = PlantError::State { value: "damaged".into(), allowed: "must not be".into() };
        assert_eq!(guarded.begin(|_| Err::<(), _>(told.clone())), Err(told));
        assert!(guarded.begin(breaks).is_err() && guarded.require_sound().is_err());
        assert_eq!(
            guarded.begin(|value| {
                *value = vec![2];
                Ok(())
            }),
            Ok(())
        );
        assert_eq!(guarded.change(|value| Ok(value.len())), Ok(1));
    }

    #[test]
    fn an_error_leaves_a_value_in_use() {
        let mut guarded = Guarded::new(1);
        let told = PlantError::State { value: "damaged".into(), allowed: "must not be".into() };
        assert_eq!(guarded.change(|_| Err::<(), _>(told.clone())), Err(told.clone()));
        assert_eq!(guarded.begin(|_| Err::<(), _>(told.clone())), Err(told));
        assert_eq!(guarded.change(|value| Ok(*value)), Ok(1));
    }

    #[test]
    fn a_panic_of_another_thread_is_an_error_of_the_one_that_waits() {
        let error = caught(|| rayon::join(|| (), || breaks(&mut Vec::new())).1);
        assert!(matches!(error, Err(PlantError::Internal { .. })));
        let scoped = caught(|| {
            std::thread::scope(|scope| {
                scope.spawn(|| breaks(&mut Vec::new()));
            });
            Ok(())
        });
        assert!(matches!(scoped, Err(PlantError::Internal { .. })));
    }
}
