//! Normal equations of many poses with the poses eliminated (Schur complement).
//!
//! A pose has the rows `r + J dx + G dg` with its own step `dx` and the common step `dg`. With the
//! Cholesky factor `L L^T = J^T J`, `y = L^-1 J^T r` and `Y = L^-1 J^T G`, the reduced normal equations have the matrix
//! `S = sum (G^T G - Y^T Y)` and the gradient `v = sum (G^T r - Y^T y)`, and `dx = -L^-T (y + Y dg)`.

use std::ops::Range;

use super::columns::{Packed, packed};
use super::equations::Equations;
use super::layout::{CABLE_COLUMNS, Layout};
use crate::estimation::observation::ObservationKind as Kind;
use crate::real::{Packet, negated, scaled, square_norm};
use crate::small_cholesky::{TRIANGLE, back_substitute, entry, factorise, forward_substitute};

/// Elimination of one packet of poses.
#[derive(Clone)]
pub(in crate::estimation) struct Elimination<T> {
    /// Lower triangle of `L`, row by row, with the reciprocals of its diagonal.
    pub factor: [T; TRIANGLE],
    /// `y`.
    pub residual: [T; 6],
    /// `Y`, column by column.
    pub columns: Vec<[T; 6]>,
}

/// Reduced normal equations, summed over all poses.
#[derive(Clone)]
pub(in crate::estimation) struct Sums<T: Packet> {
    token: T::Token,
    /// Lower triangle of `S`, row by row, in packets.
    information: Packed,
    /// `v`, in packets.
    gradient: Packed,
    /// Loss of the rows.
    pub loss: f64,
    /// `sum y.y`: predicted reduction of the loss by the steps of the poses alone.
    pub predicted_reduction: f64,
    /// Number of rows that were measured.
    pub readings: f64,
    /// Number of pose coordinates that the rows determine.
    pub coordinates: f64,
}

impl<T: Packet> Elimination<T> {
    pub fn new(layout: &Layout, zero: T) -> Self {
        Self {
            factor: [zero; TRIANGLE],
            residual: [zero; 6],
            columns: vec![[zero; 6]; layout.columns],
        }
    }

    /// Eliminates the poses from `equations`. Coordinates that no reading depends on stay where they are.
    #[inline(always)]
    pub fn eliminate(&mut self, equations: &Equations<T>, layout: &Layout, damping: f64) {
        let zero = equations.laser_by_plane.lift(0.0);
        let mut hessian = [zero; TRIANGLE];
        let mut gradient = [zero; 6];
        for (j, r) in equations.by_pose.iter().zip(&equations.residual) {
            for k in 0..6 {
                gradient[k] = j[k].mul_add(*r, gradient[k]);
                for q in 0..=k {
                    let at = entry(k, q);
                    hessian[at] = j[k].mul_add(j[q], hessian[at]);
                }
            }
        }
        self.project(equations, layout, zero);
        factorise(&mut hessian, damping);
        self.factor = hessian;
        self.residual = gradient;
        forward_substitute(&self.factor, &mut self.residual);
        for column in &mut self.columns {
            forward_substitute(&self.factor, column);
        }
    }

    /// `J^T G`.
    #[inline(always)]
    fn project(&mut self, equations: &Equations<T>, layout: &Layout, zero: T) {
        for (cable, g) in equations.length_by_cable.iter().enumerate() {
            let first = layout.cable_column(cable);
            let columns = &mut self.columns[first..first + CABLE_COLUMNS];
            let j = &equations.by_pose[cable];
            for (column, g) in columns.iter_mut().zip(g) {
                *column = scaled(*j, *g);
            }
        }
        if let Some(first_row) = layout.swivel {
            for (cable, g) in equations.swivel_by_cable.iter().enumerate() {
                let first = layout.cable_column(cable);
                let j = &equations.by_pose[first_row + cable];
                for (column, g) in self.columns[first..first + 3].iter_mut().zip(g) {
                    add_product(column, j, *g);
                }
            }
        }
        let plane = layout.plane_column();
        self.columns[plane] = match layout.laser {
            Some(row) => scaled(equations.by_pose[row], equations.laser_by_plane),
            None => [zero; 6],
        };
        for column in &mut self.columns[layout.effect_column()..] {
            *column = [zero; 6];
        }
        let columns = &mut self.columns[layout.effect_column()..];
        for (row, j) in equations.by_pose.iter().enumerate() {
            let effects = &equations.by_effect[layout.effect_range(row)];
            for (column, e) in layout.effects_of(row).iter().zip(effects) {
                add_product(&mut columns[*column], j, *e);
            }
        }
        if let Some(first_row) = layout.equilibrium {
            let rows = &equations.by_pose[first_row..first_row + 6];
            for (column, g) in self
                .columns
                .iter_mut()
                .zip(&equations.equilibrium_by_column)
            {
                for (j, g) in rows.iter().zip(g) {
                    add_product(column, j, *g);
                }
            }
        }
    }

    /// `L^-1 j` of one row.
    #[inline(always)]
    pub fn half_solve(&self, mut row: [T; 6]) -> [T; 6] {
        forward_substitute(&self.factor, &mut row);
        row
    }

    /// Derivative of a row with respect to the columns with the pose eliminated:
    /// `g - Y^T y` with `y = L^-1 j`, written to `gradient`.
    #[inline(always)]
    pub fn remaining_gradient(
        &self,
        equations: &Equations<T>,
        layout: &Layout,
        row: usize,
        y: [T; 6],
        gradient: &mut [T],
    ) {
        for (entry, column) in gradient.iter_mut().zip(&self.columns) {
            let mut sum = -(column[0] * y[0]);
            for k in 1..6 {
                sum = sum.minus_product(column[k], y[k]);
            }
            *entry = sum;
        }
        match layout.kinds[row] {
            Kind::Equilibrium(axis) => {
                for (entry, g) in gradient.iter_mut().zip(&equations.equilibrium_by_column) {
                    *entry = *entry + g[axis.index()];
                }
                return;
            }
            Kind::Length(cable) => {
                let g = &equations.length_by_cable[cable];
                add_to(&mut gradient[layout.cable_column(cable)..], g);
            }
            Kind::Swivel(cable) => {
                let g = &equations.swivel_by_cable[cable];
                add_to(&mut gradient[layout.cable_column(cable)..], g);
            }
            Kind::Laser => {
                let plane = layout.plane_column();
                gradient[plane] = gradient[plane] + equations.laser_by_plane;
            }
            // A tension reading has no row.
            Kind::Tension(_)
            | Kind::TrackerPosition(_)
            | Kind::TrackerOrientation(_)
            | Kind::Inclination(_)
            | Kind::Distance(_) => {}
        }
        let effects = &equations.by_effect[layout.effect_range(row)];
        for (column, e) in layout.effects_of(row).iter().zip(effects) {
            let entry = &mut gradient[layout.effect_column() + column];
            *entry = *entry + *e;
        }
    }

    /// Step `dx` of the poses, from `y` and `Y dg`.
    #[inline(always)]
    pub fn pose_step(factor: &[T; TRIANGLE], residual: [T; 6], moved: [T; 6]) -> [T; 6] {
        let mut x = residual;
        for k in 0..6 {
            x[k] = -(residual[k] + moved[k]);
        }
        back_substitute(factor, &mut x);
        x
    }
}

#[inline(always)]
fn add_to<T: Packet>(sum: &mut [T], terms: &[T]) {
    for (entry, term) in sum.iter_mut().zip(terms) {
        *entry = *entry + *term;
    }
}

#[inline(always)]
fn add_product<T: Packet>(column: &mut [T; 6], j: &[T; 6], g: T) {
    for k in 0..6 {
        column[k] = j[k].mul_add(g, column[k]);
    }
}

impl<T: Packet> Sums<T> {
    pub fn new(token: T::Token, layout: &Layout) -> Self {
        let n = layout.columns;
        Self {
            token,
            information: packed(n * (n + 1) / 2 * T::LANES),
            gradient: packed(n * T::LANES),
            loss: 0.0,
            predicted_reduction: 0.0,
            readings: 0.0,
            coordinates: 0.0,
        }
    }

    pub fn clear(&mut self) {
        self.information.fill(0.0);
        self.gradient.fill(0.0);
        self.loss = 0.0;
        self.predicted_reduction = 0.0;
        self.readings = 0.0;
        self.coordinates = 0.0;
    }

    /// Adds one packet of poses.
    #[inline(always)]
    pub fn add(&mut self, equations: &Equations<T>, elimination: &Elimination<T>, layout: &Layout) {
        let y = &elimination.residual;
        self.predicted_reduction += square_norm(*y).sum();
        let zero = y[0].lift(0.0);
        let one = y[0].lift(1.0);
        let mut readings = zero;
        for present in &equations.present {
            readings = readings + *present;
        }
        self.readings += readings.sum();
        let mut determined = zero;
        for k in 0..6 {
            let inverse = elimination.factor[entry(k, k)];
            determined = determined + inverse.select_positive(one, zero);
        }
        self.coordinates += determined.sum();
        match layout.equilibrium {
            None => self.add_columns(elimination, y, None),
            Some(first) => {
                let equilibrium = &equations.equilibrium_by_column;
                let mut residual = *y;
                residual.copy_from_slice(&equations.residual[first..first + 6]);
                self.add_columns(elimination, y, Some((equilibrium, &residual)));
            }
        }
        self.add_sparse(equations, layout);
    }

    /// Subtracts `Y^T Y` and adds `G^T G` of the equilibrium rows.
    #[inline(always)]
    fn add_columns(
        &mut self,
        elimination: &Elimination<T>,
        y: &[T; 6],
        equilibrium: Option<(&Vec<[T; 6]>, &[T; 6])>,
    ) {
        let columns = &elimination.columns;
        for (i, column) in columns.iter().enumerate() {
            let minus = negated(*column);
            let mut gradient = T::load(self.token, &self.gradient, i);
            for k in 0..6 {
                gradient = minus[k].mul_add(y[k], gradient);
            }
            if let Some((columns, residual)) = equilibrium {
                for k in 0..6 {
                    gradient = columns[i][k].mul_add(residual[k], gradient);
                }
            }
            gradient.store(&mut self.gradient, i);
        }
        let equilibrium = equilibrium.map(|(columns, _)| columns.as_slice());
        // Two rows of the triangle at a time: what is loaded of a column serves both.
        for i in (0..columns.len()).step_by(2) {
            if i + 1 < columns.len() {
                self.add_products([i, i + 1], 0..i + 1, columns, equilibrium);
                self.add_products([i + 1], i + 1..i + 2, columns, equilibrium);
            } else {
                self.add_products([i], 0..i + 1, columns, equilibrium);
            }
        }
    }

    /// The part of [`Self::add_columns`] for some rows of the triangle and a range of their columns.
    #[inline(always)]
    fn add_products<const N: usize>(
        &mut self,
        rows: [usize; N],
        range: Range<usize>,
        y: &[[T; 6]],
        equilibrium: Option<&[[T; 6]]>,
    ) {
        // Loops, because closures are compiled without the instructions of the kernel.
        let mut minus = [y[0]; N];
        let mut starts = [0; N];
        for n in 0..N {
            minus[n] = negated(y[rows[n]]);
            starts[n] = entry(rows[n], 0);
        }
        match equilibrium {
            None => {
                for j in range {
                    let other = y[j];
                    for n in 0..N {
                        let mut sum = T::load(self.token, &self.information, starts[n] + j);
                        for k in 0..6 {
                            sum = minus[n][k].mul_add(other[k], sum);
                        }
                        sum.store(&mut self.information, starts[n] + j);
                    }
                }
            }
            Some(columns) => {
                let mut g = minus;
                for n in 0..N {
                    g[n] = columns[rows[n]];
                }
                for j in range {
                    let (other, h) = (y[j], columns[j]);
                    for n in 0..N {
                        let mut sum = T::load(self.token, &self.information, starts[n] + j);
                        let mut more = other[0].lift(0.0);
                        for k in 0..6 {
                            sum = minus[n][k].mul_add(other[k], sum);
                            more = g[n][k].mul_add(h[k], more);
                        }
                        (sum + more).store(&mut self.information, starts[n] + j);
                    }
                }
            }
        }
    }

    /// Adds `G^T G` of all other rows, each of which has few nonzero columns.
    #[inline(always)]
    fn add_sparse(&mut self, equations: &Equations<T>, layout: &Layout) {
        for (cable, g) in equations.length_by_cable.iter().enumerate() {
            self.add_block(layout.cable_column(cable), g, equations.residual[cable]);
            self.add_effects(layout.cable_column(cable), g, cable, equations, layout);
        }
        if let Some(first) = layout.swivel {
            for (cable, g) in equations.swivel_by_cable.iter().enumerate() {
                self.add_block(
                    layout.cable_column(cable),
                    g,
                    equations.residual[first + cable],
                );
                let row = first + cable;
                self.add_effects(layout.cable_column(cable), g, row, equations, layout);
            }
        }
        if let Some(row) = layout.laser {
            let g = [equations.laser_by_plane];
            self.add_block(layout.plane_column(), &g, equations.residual[row]);
            self.add_effects(layout.plane_column(), &g, row, equations, layout);
        }
        for row in 0..layout.rows {
            self.add_effect_block(row, equations, layout);
        }
    }

    /// Adds the products of a row's effect derivatives with each other and with its residual.
    #[inline(always)]
    fn add_effect_block(&mut self, row: usize, equations: &Equations<T>, layout: &Layout) {
        let own = layout.effects_of(row);
        let effects = &equations.by_effect[layout.effect_range(row)];
        let first = layout.effect_column();
        for (k, (column, e)) in own.iter().zip(effects).enumerate() {
            let column = first + column;
            let gradient = T::load(self.token, &self.gradient, column);
            e.mul_add(equations.residual[row], gradient)
                .store(&mut self.gradient, column);
            for (other, e_other) in own[..=k].iter().zip(effects) {
                let at = entry(column, first + other);
                let sum = T::load(self.token, &self.information, at);
                e.mul_add(*e_other, sum).store(&mut self.information, at);
            }
        }
    }

    /// Adds `g g^T` and `g r` for consecutive columns from `first`.
    #[inline(always)]
    fn add_block(&mut self, first: usize, g: &[T], residual: T) {
        for (k, g_k) in g.iter().enumerate() {
            let row = first + k;
            let gradient = T::load(self.token, &self.gradient, row);
            g_k.mul_add(residual, gradient)
                .store(&mut self.gradient, row);
            for (q, g_q) in g[..=k].iter().enumerate() {
                let at = entry(row, first + q);
                let sum = T::load(self.token, &self.information, at);
                g_k.mul_add(*g_q, sum).store(&mut self.information, at);
            }
        }
    }

    /// Adds the products of a row's own columns with its effect derivatives.
    #[inline(always)]
    fn add_effects(
        &mut self,
        first: usize,
        g: &[T],
        row: usize,
        equations: &Equations<T>,
        layout: &Layout,
    ) {
        let effects = &equations.by_effect[layout.effect_range(row)];
        for (column, by_effect) in layout.effects_of(row).iter().zip(effects) {
            let column = layout.effect_column() + column;
            for (q, g_q) in g.iter().enumerate() {
                let at = entry(column, first + q);
                let sum = T::load(self.token, &self.information, at);
                by_effect
                    .mul_add(*g_q, sum)
                    .store(&mut self.information, at);
            }
        }
    }

    /// Adds the sums over other poses.
    pub fn add_sums(&mut self, other: &Self) {
        let own = self.information.iter_mut().chain(&mut *self.gradient);
        for (sum, term) in own.zip(other.information.iter().chain(&*other.gradient)) {
            *sum += term;
        }
        self.loss += other.loss;
        self.predicted_reduction += other.predicted_reduction;
        self.readings += other.readings;
        self.coordinates += other.coordinates;
    }

    /// Whether any row depends on a column; NaN counts as a dependence.
    pub fn concerns(&self, column: usize) -> bool {
        let first = entry(column, column) * T::LANES;
        let diagonal = &self.information[first..first + T::LANES];
        diagonal.iter().any(|value| *value != 0.0)
    }

    /// Lower triangle of `S`, row by row.
    pub fn information(&self) -> Vec<f64> {
        self.information
            .chunks_exact(T::LANES)
            .map(|c| c.iter().sum())
            .collect()
    }

    /// `v`.
    pub fn gradient(&self) -> Vec<f64> {
        self.gradient
            .chunks_exact(T::LANES)
            .map(|c| c.iter().sum())
            .collect()
    }
}
