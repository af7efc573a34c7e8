//! Four fields side by side, so that all values at a corner are loaded in one vector.

use super::Corners;
use crate::grid::Field;
use crate::numbers::F64x4;
use std::ops::Range;

/// The values of four fields of one shape in a range of places in their memory, with those of one place side by side.
#[derive(Clone, Debug, Default)]
pub(crate) struct FourFields {
    places: Range<usize>,
    values: Vec<AtPlace>,
}

/// The values at one place.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
struct AtPlace([f64; 4]);

impl FourFields {
    /// Copies the values of fields in a range of places.
    pub(crate) fn copy_from(&mut self, fields: [&Field; 4], places: Range<usize>) {
        let [a, b, c, d] = fields.map(|field| &field.values()[places.clone()]);
        let values = a.iter().zip(b).zip(c).zip(d);
        self.values.clear();
        self.values.extend(values.map(|(((&a, &b), &c), &d)| AtPlace([a, b, c, d])));
        self.places = places;
    }

    /// Sets all values to zero, in a range of places.
    pub(crate) fn clear(&mut self, places: Range<usize>) {
        self.values.clear();
        self.values.resize(places.len(), AtPlace::default());
        self.places = places;
    }

    /// Sets fields to these values, and to zero elsewhere.
    pub(crate) fn copy_to(&self, fields: [&mut Field; 4]) {
        for (number, field) in fields.into_iter().enumerate() {
            let values = field.values_mut();
            values[..self.places.start].fill(0.0);
            values[self.places.end..].fill(0.0);
            let inside = &mut values[self.places.clone()];
            inside.iter_mut().zip(&self.values).for_each(|(to, from)| *to = from.0[number]);
        }
    }

    /// The values at a point, as by [`interpolate`](super::interpolate).
    #[inline(always)]
    pub(crate) fn interpolate<Q: F64x4>(&self, corners: &Corners) -> Q {
        let mut sum = Q::splat(0.0);
        for (place, weight) in corners.iter() {
            let values = Q::load(&self.values[place - self.places.start].0);
            sum = sum.plus(Q::splat(weight).times(values));
        }
        sum
    }

    /// Adds amounts to the cells around a point, as [`deposit`](super::deposit) does; `shifts` are the rounding shifts
    /// of the quanta.
    #[inline(always)]
    pub(crate) fn deposit<Q: F64x4>(&mut self, corners: &Corners, amounts: Q, shifts: Q) {
        for (place, weight) in corners.iter() {
            let values = &mut self.values[place - self.places.start].0;
            let share = amounts.times(Q::splat(weight)).plus(shifts).minus(shifts);
            Q::load(values).plus(share).store(values);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CellTransfer, deposit, interpolate};
    use super::*;
    use crate::domain::{Bounds, Decomposition, Face, RankGrid};
    use crate::grid::BoxGrid;
    use crate::numbers::{Quantum, random_of, uniform, vectorised};
    use nalgebra::Vector3;

    vectorised!(
        fn back_and_forth<Q: F64x4>(
            corners: &[Corners],
            from: &FourFields,
            shifts: [f64; 4],
            to: &mut FourFields,
        ) -> Vec<[f64; 4]> {
            let mut found = vec![[0.0; 4]; corners.len()];
            for (corners, found) in corners.iter().zip(&mut found) {
                let values: Q = from.interpolate(corners);
                values.store(found);
                to.deposit(corners, values, Q::load(&shifts));
            }
            found
        }
    );

    #[test]
    fn four_fields_at_once_have_the_bits_of_each_by_itself() {
        let mut random = random_of(1, 0, "four fields");
        let mut number = || uniform(&mut random) - 0.3;
        let bounds = Bounds::new(Vector3::new(3.0, 2.0, 4.0), [[Face::Wall; 2]; 3]);
        let grid = BoxGrid::new(&bounds, [6, 4, 8]);
        let decomposition = Decomposition::even(RankGrid([1; 3]), &bounds);
        let subdomain = decomposition.subdomain(&bounds, 0);
        let mut field = Field::new(&grid.local_cells(subdomain), 2);
        let transfer = CellTransfer::new((&grid, None), 0.0, subdomain, &field);
        let mut fields = [0; 4].map(|_| {
            field.values_mut().iter_mut().for_each(|value| *value = number());
            field.clone()
        });
        let corners: Vec<Corners> = (0..50)
            .map(|_| {
                let position = Vector3::from_fn(|axis, _| (number() + 0.3) * [3.0, 2.0, 4.0][axis]);
                transfer.corners_at(&position, &field)
            })
            .collect();
        let quanta = [1.0, 2.0, 40.0, 500.0].map(Quantum::spanning);
        let places = Corners::places_of(&corners);
        let (mut from, mut to) = (FourFields::default(), FourFields::default());
        from.copy_from(fields.each_ref(), places.clone());
        to.clear(places.clone());
        let shifts = quanta.map(Quantum::shift);
        let found = back_and_forth(&corners, &from, shifts, &mut to);

        let one_by_one: Vec<[f64; 4]> =
            corners.iter().map(|corners| interpolate(fields.each_ref(), corners)).collect();
        assert_eq!(found, one_by_one);
        let mut expected = [0; 4].map(|_| Field::new(&grid.local_cells(subdomain), 2));
        for (corners, &amounts) in corners.iter().zip(&found) {
            deposit(expected.each_mut(), quanta, corners, amounts);
        }
        to.copy_to(fields.each_mut());
        for (field, expected) in fields.iter().zip(&expected) {
            assert_eq!(field.values(), expected.values());
        }
        assert!(expected[0].values()[places].iter().any(|&value| value != 0.0)); // a control
    }
}
