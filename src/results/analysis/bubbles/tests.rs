//! Discs and spheres drawn on grids.

use super::*;

const THICK: f64 = 0.5;

/// A disc or sphere: centre, radius, ratio of vertical to horizontal size.
type Drawn = ([f64; 3], f64, f64);

struct Grid {
    cells: [usize; 3],
    spacing: f64,
    periodic: [bool; 2],
    values: Vec<f64>,
}

impl Grid {
    /// Voidage 0.4 below the surface and 1 above; 0.95 inside the drawn shapes.
    fn draw(
        cells: [usize; 3],
        spacing: f64,
        periodic: [bool; 2],
        surface: f64,
        drawn: &[Drawn],
    ) -> Self {
        let mut values = Vec::new();
        for z in 0..cells[2] {
            for y in 0..cells[1] {
                for x in 0..cells[0] {
                    let at = [x, y, z].map(|index| (index as f64 + 0.5) * spacing);
                    let inside = drawn.iter().any(|(centre, radius, tall)| {
                        let mut square = 0.0;
                        for direction in 0..3 {
                            let length = cells[direction] as f64 * spacing;
                            let mut way = at[direction] - centre[direction];
                            if direction < 2 && periodic[direction] {
                                way -= length * (way / length).round();
                            }
                            if cells[direction] == 1 {
                                way = 0.0;
                            }
                            let scale = if direction == 2 { radius * tall } else { *radius };
                            square += way * way / (scale * scale);
                        }
                        square < 1.0
                    });
                    values.push(match (at[2] > surface, inside) {
                        (true, _) => 1.0,
                        (_, true) => 0.95,
                        _ => 0.4,
                    });
                }
            }
        }
        Self { cells, spacing, periodic, values }
    }

    fn bubbles(&self) -> Vec<Bubble> {
        let mut spacing = [self.spacing; 3];
        if self.cells[1] == 1 {
            spacing[1] = THICK;
        }
        let field = VoidageField {
            values: &self.values,
            cells: self.cells,
            origin: [0.0; 3],
            spacing,
            periodic: self.periodic,
        };
        find_bubbles(&field, &BubbleOptions::default()).unwrap()
    }
}

#[test]
fn discs_have_their_area_place_and_shape_and_the_freeboard_is_left_out() {
    let drawn = [([10.0, 0.0, 12.0], 4.0, 1.0), ([25.0, 0.0, 20.0], 3.0, 1.5)];
    let bubbles = Grid::draw([160, 1, 200], 0.25, [false; 2], 35.0, &drawn).bubbles();
    assert_eq!(bubbles.len(), 2);
    for (bubble, (centre, radius, tall)) in bubbles.iter().zip(drawn) {
        let area = std::f64::consts::PI * radius * radius * tall;
        // Cells of a sixteenth of the radius give an error of a per cent.
        assert!((bubble.volume / THICK / area - 1.0).abs() < 0.01, "{bubble:?}");
        assert!((bubble.equivalent_diameter / (2.0 * radius * tall.sqrt()) - 1.0).abs() < 0.005);
        assert!((bubble.aspect_ratio / tall - 1.0).abs() < 0.01, "{bubble:?}");
        assert!((bubble.centroid[0] - centre[0]).abs() < 0.02);
        assert!((bubble.centroid[2] - centre[2]).abs() < 0.02);
        assert!((bubble.vertical_extent[1] - centre[2] - radius * tall).abs() <= 0.25);
        assert!(!bubble.encircles);
    }
}

#[test]
fn a_bubble_that_opens_to_the_freeboard_is_none() {
    let drawn = [([10.0, 0.0, 33.0], 4.0, 1.0)];
    assert!(Grid::draw([80, 1, 200], 0.25, [false; 2], 35.0, &drawn).bubbles().is_empty());
    let packed = Grid::draw([80, 1, 200], 0.25, [false; 2], 35.0, &[]);
    assert!(packed.bubbles().is_empty());
}

#[test]
fn a_sphere_across_the_periodic_border_is_one_bubble() {
    let drawn = [([0.5, 9.8, 10.0], 3.0, 1.0)];
    let bubbles = Grid::draw([40, 40, 80], 0.25, [true; 2], 18.0, &drawn).bubbles();
    assert_eq!(bubbles.len(), 1);
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 27.0;
    assert!((bubbles[0].volume / volume - 1.0).abs() < 0.02, "{bubbles:?}");
    assert!((bubbles[0].aspect_ratio - 1.0).abs() < 0.01);
    let off = |a: f64, b: f64| ((a - b) - 10.0 * ((a - b) / 10.0).round()).abs();
    assert!(off(bubbles[0].centroid[0], 0.5) < 0.05 && off(bubbles[0].centroid[1], 9.8) < 0.05);
    // The same without periodic borders is four pieces.
    let mut grid = Grid::draw([40, 40, 80], 0.25, [true; 2], 18.0, &drawn);
    grid.periodic = [false; 2];
    assert_eq!(grid.bubbles().len(), 4);
    let slug = Grid::draw([40, 40, 80], 0.25, [true; 2], 18.0, &[([5.0, 5.0, 10.0], 8.0, 0.3)]);
    assert!(slug.bubbles()[0].encircles);
}

#[test]
fn rising_discs_have_their_velocities() {
    let times: Vec<f64> = (0..30).map(|index| 0.1 * f64::from(index)).collect();
    let speeds = [5.0, 8.0];
    let frames: Vec<Vec<Bubble>> = times
        .iter()
        .map(|time| {
            let drawn = [
                ([6.0, 0.0, 6.0 + speeds[0] * time], 2.0, 1.0),
                // These also move sideways across the periodic border.
                ([15.0 + 3.0 * time, 0.0, 5.0 + speeds[1] * time], 1.5, 1.0),
            ];
            Grid::draw([80, 1, 200], 0.25, [true, false], 40.0, &drawn).bubbles()
        })
        .collect();
    let options = TrackingOptions {
        farthest: 1.5,
        largest_growth: 2.0,
        periods: [Some(20.0), None],
        fewest_times: 10,
    };
    let tracks = track_bubbles(&times, &frames, &options).unwrap();
    assert_eq!(tracks.len(), 2);
    for speed in speeds {
        let track = tracks.iter().find(|track| (track.rise_velocity.value - speed).abs() < 0.5);
        let velocity = track.unwrap().rise_velocity;
        // Centroids on cells of 0.25 wander by 0.02 over a rise of 15.
        assert!((velocity.value / speed - 1.0).abs() < 0.003, "{velocity:?}");
    }
}

#[test]
fn bubbles_that_merge_are_others_and_bad_input_is_refused() {
    let one = Grid::draw([80, 1, 100], 0.25, [false; 2], 20.0, &[([10.0, 0.0, 8.0], 1.5, 1.0)]);
    let merged = Grid::draw([80, 1, 100], 0.25, [false; 2], 20.0, &[([10.0, 0.0, 9.0], 3.0, 1.0)]);
    let frames = [one.bubbles(), one.bubbles(), one.bubbles(), merged.bubbles()];
    let options =
        TrackingOptions { farthest: 2.0, largest_growth: 2.0, periods: [None; 2], fewest_times: 3 };
    let tracks = track_bubbles(&[0.0, 1.0, 2.0, 3.0], &frames, &options).unwrap();
    assert_eq!(tracks.len(), 1);
    assert_eq!(tracks[0].times.len(), 3);
    assert!(track_bubbles(&[0.0], &frames, &options).is_err());
    let field = VoidageField {
        values: &[0.5; 7],
        cells: [2, 2, 2],
        origin: [0.0; 3],
        spacing: [1.0; 3],
        periodic: [false; 2],
    };
    let reason = find_bubbles(&field, &BubbleOptions::default()).unwrap_err();
    assert!(reason.reason().contains("7 values for 8 cells"));
}
