//! Third-party readers that panic on damaged files.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    static READS: Cell<bool> = const { Cell::new(false) };
}
static HOOK: Once = Once::new();

/// Runs a reader that may panic on damaged input; a panic prints nothing and returns `None`.
pub fn read_damaged<T>(read: impl FnOnce() -> T) -> Option<T> {
    HOOK.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !READS.get() {
                usual(info);
            }
        }));
    });
    READS.set(true);
    let read_or_not = catch_unwind(AssertUnwindSafe(read));
    READS.set(false);
    read_or_not.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_says_that_the_input_is_damaged() {
        assert_eq!(read_damaged(|| 3), Some(3));
        assert_eq!(read_damaged(|| panic!("no end")), None::<()>);
        assert!(!READS.get());
    }
}
