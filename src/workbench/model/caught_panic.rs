//! Panics as values: the window shows them and keeps running.

use std::any::Any;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, Once, PoisonError};

/// Source location of the last panic, from the hook.
static LAST: Mutex<Option<String>> = Mutex::new(None);
static HOOK: Once = Once::new();

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaughtPanic {
    /// Panic message with source location.
    pub message: String,
}

/// Records the messages of panics, in addition to the usual hook.
pub fn listen() {
    HOOK.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            *LAST.lock().unwrap_or_else(PoisonError::into_inner) = Some(info.to_string());
            usual(info);
        }));
    });
}

/// Runs `work` and catches its panic.
///
/// # Errors
/// The panic.
pub fn guard<T>(work: impl FnOnce() -> T) -> Result<T, CaughtPanic> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| CaughtPanic {
        message: message(&*payload),
    })
}

fn message(payload: &(dyn Any + Send)) -> String {
    let recorded = LAST.lock().unwrap_or_else(PoisonError::into_inner).take();
    recorded.unwrap_or_else(|| {
        let text = payload
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned());
        text.or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "no reason was given".into())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_value_with_its_message() {
        assert_eq!(guard(|| 3), Ok(3));
        let broken = guard(|| panic!("the cable tore")).expect_err("a caught_panic");
        assert!(
            broken.message.contains("the cable tore"),
            "{}",
            broken.message
        );
    }
}
