//! A value that is recomputed only when its key changes.

/// Last value with its key.
#[derive(Debug)]
pub struct Memo<K, T> {
    kept: Option<(K, T)>,
}

impl<K, T> Default for Memo<K, T> {
    fn default() -> Self {
        Self { kept: None }
    }
}

impl<K: PartialEq, T> Memo<K, T> {
    pub fn get(&mut self, key: K, compute: impl FnOnce() -> T) -> &T {
        let kept = match self.kept.take() {
            Some((of, value)) if of == key => (key, value),
            _ => (key, compute()),
        };
        &self.kept.insert(kept).1
    }
}

#[cfg(test)]
mod tests {
    use crate::model::Memo;

    #[test]
    fn it_computes_once_per_key() {
        let mut memo = Memo::default();
        let mut calls = 0;
        for key in [1, 1, 2, 2, 1] {
            let value = *memo.get(key, || {
                calls += 1;
                key * 10
            });
            assert_eq!(value, key * 10);
        }
        assert_eq!(calls, 3);
    }
}
