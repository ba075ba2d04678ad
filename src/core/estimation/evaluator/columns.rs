//! Values of many poses, laid out so that a packet of poses is one load.

use aligned_vec::{AVec, ConstAlign};

use crate::effect::{CablePorts, PlatformPorts};
use crate::real::Packet;

/// Location of a quantity: one packet for all poses, or one per batch of poses.
#[derive(Debug, Clone, Copy)]
pub(super) struct StoredColumn {
    offset: usize,
    stride: usize,
}

/// Numbers in whole packets, aligned to cache lines.
pub(super) type Packed = AVec<f64, ConstAlign<64>>;

/// Zeros in whole packets, at least `count` of them.
pub(super) fn packed(count: usize) -> Packed {
    let mut values = AVec::with_capacity(64, count);
    values.resize(count, 0.0);
    values
}

fn extend(packed: &mut Packed, values: impl Iterator<Item = f64>) {
    packed.reserve(values.size_hint().0);
    for value in values {
        packed.push(value);
    }
}

/// A store of columns, each a sequence of packets.
#[derive(Clone)]
pub(super) struct ColumnStore<T: Packet> {
    token: T::Token,
    values: Packed,
}

impl<T: Packet> ColumnStore<T> {
    pub fn new(token: T::Token) -> Self {
        Self {
            token,
            values: packed(0),
        }
    }

    /// Adds a quantity that is the same at all poses.
    pub fn uniform(&mut self, value: f64) -> StoredColumn {
        let offset = self.values.len() / T::LANES;
        extend(&mut self.values, std::iter::repeat_n(value, T::LANES));
        StoredColumn { offset, stride: 0 }
    }

    /// Adds a quantity with one value per pose; the last packet is padded with `padding`.
    pub fn varying(&mut self, values: impl Iterator<Item = f64>, padding: f64) -> StoredColumn {
        let start = self.values.len();
        extend(&mut self.values, values);
        let count = self.values.len() - start;
        let missing = count.next_multiple_of(T::LANES) - count;
        extend(&mut self.values, std::iter::repeat_n(padding, missing));
        let offset = start / T::LANES;
        StoredColumn { offset, stride: 1 }
    }

    /// Loads the ports of a cable for a batch.
    #[inline(always)]
    pub fn load_cable(&self, ports: &CablePorts<StoredColumn>, batch: usize) -> CablePorts<T> {
        CablePorts::from_fn(|port| self.load(ports.get(port), batch))
    }

    /// Loads the ports of the platform for a batch.
    #[inline(always)]
    pub fn load_platform(
        &self,
        ports: &PlatformPorts<StoredColumn>,
        batch: usize,
    ) -> PlatformPorts<T> {
        PlatformPorts::from_fn(|port| self.load(ports.get(port), batch))
    }

    /// Loads the first three of the given columns for a batch.
    #[inline(always)]
    pub fn load_three(&self, columns: &[StoredColumn], batch: usize) -> [T; 3] {
        [
            self.load(columns[0], batch),
            self.load(columns[1], batch),
            self.load(columns[2], batch),
        ]
    }

    /// Loads a column for a batch.
    #[inline(always)]
    pub fn load(&self, column: StoredColumn, batch: usize) -> T {
        let packet = column.offset + column.stride * batch;
        T::load(self.token, &self.values, packet)
    }
}
