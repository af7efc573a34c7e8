//! Rods, discs, balls and clusters of known dimension; a wrong dimension is detected.

use super::*;
use crate::analysis::statistics::SampleMean;
use nalgebra::{Rotation3, Unit};
use rand_chacha::ChaCha8Rng;
use talcum_engine::numbers::{normal, random_of, uniform};
use talcum_engine::parallel::run_on_threads;

/// Touching spheres of radius 1 with their centre of mass at the origin.
type Cluster = Vec<Vector3<f64>>;

fn centred(mut cluster: Cluster) -> Cluster {
    let centre = cluster.iter().sum::<Vector3<f64>>() / cluster.len() as f64;
    cluster.iter_mut().for_each(|x| *x -= centre);
    cluster
}

fn gyration_squared(cluster: &Cluster) -> f64 {
    cluster.iter().map(|x| x.norm_squared()).sum::<f64>() / cluster.len() as f64
}

fn direction(generator: &mut ChaCha8Rng) -> Unit<Vector3<f64>> {
    Unit::new_normalize(Vector3::from_fn(|_, _| normal(generator)))
}

/// Joins two clusters so that n = k R^D holds for the whole, where R is its radius of gyration: tunable cluster-cluster
/// aggregation (Filippov, Zurita & Rosner, J. Colloid Interface Sci. 229 (2000) 261, doi:10.1006/jcis.2000.7027).
/// `None` if no contact at that distance is found.
fn joined(
    a: &Cluster,
    b: &Cluster,
    law: (f64, f64),
    generator: &mut ChaCha8Rng,
) -> Option<Cluster> {
    let (k, dimension) = law;
    let [m, n] = [a.len() as f64, b.len() as f64];
    let target = ((m + n) / k).powf(2.0 / dimension);
    let own = (m * gyration_squared(a) + n * gyration_squared(b)) / (m + n);
    let distance = ((target - own) * (m + n) * (m + n) / (m * n)).sqrt();
    for _ in 0..3000 {
        let shift = distance * direction(generator).into_inner();
        let pick = |cluster: &Cluster, x: f64| cluster[(x * cluster.len() as f64) as usize];
        let here = pick(a, uniform(generator));
        let there = pick(b, uniform(generator));
        // A point at distance 2 of `here`, and at the distance of `there` from the centre of b.
        let axis = shift - here;
        let gap = axis.norm();
        let cosine = (gap * gap + 4.0 - there.norm_squared()) / (4.0 * gap);
        if cosine.abs() > 1.0 || there.norm() == 0.0 {
            continue;
        }
        let side = axis.cross(&direction(generator)).normalize();
        let point = here + 2.0 * (cosine * axis / gap + (1.0 - cosine * cosine).sqrt() * side);
        let Some(turn) = Rotation3::rotation_between(&there, &(point - shift)) else { continue };
        let spin = Unit::new_normalize(there);
        let turn =
            turn * Rotation3::from_axis_angle(&spin, std::f64::consts::TAU * uniform(generator));
        let moved: Cluster = b.iter().map(|x| turn * x + shift).collect();
        let apart = |x: &Vector3<f64>| moved.iter().all(|y| (x - y).norm_squared() > 3.999);
        if a.iter().all(apart) {
            return Some(centred([a.clone(), moved].concat()));
        }
    }
    None
}

/// A cluster of 4 * 2^generations spheres whose parts of all generations obey n = k R^D.
fn aggregate(generations: u32, law: (f64, f64), generator: &mut ChaCha8Rng) -> Cluster {
    if generations == 0 {
        // The first four spheres form a chain.
        return centred((0..4).map(|k| Vector3::new(2.0 * f64::from(k), 0.0, 0.0)).collect());
    }
    loop {
        let a = aggregate(generations - 1, law, generator);
        let b = aggregate(generations - 1, law, generator);
        if let Some(cluster) = joined(&a, &b, law, generator) {
            return cluster;
        }
    }
}

/// The properties of a cluster as an agglomerate.
fn agglomerate(cluster: &Cluster) -> Agglomerate {
    Agglomerate {
        members: cluster.len() as u64,
        volume: cluster.len() as f64 * 4.0 / 3.0 * std::f64::consts::PI,
        radius_of_gyration: gyration_squared(cluster).sqrt(),
        ..Agglomerate::default()
    }
}

fn fit(found: &[Agglomerate]) -> PopulationFit {
    let fits = run_on_threads(3, |ranks| {
        let here: Vec<_> = found.iter().skip(ranks.rank()).step_by(3).copied().collect();
        PopulationFit::of(&here, ranks)
    });
    let alone = run_on_threads(1, |ranks| PopulationFit::of(found, ranks));
    assert!(fits.iter().all(|fit| *fit == alone[0])); // the same bits on any ranks
    alone[0].unwrap()
}

#[test]
fn populations_of_known_dimension_are_distinguished() {
    for dimension in [1.8, 2.1] {
        let law = (1.3, dimension);
        let mut found = Vec::new();
        for trial in 0..8 {
            let mut generator = random_of(1, trial, "population");
            for generations in 2..=4 {
                found.push(agglomerate(&aggregate(generations, law, &mut generator)));
            }
        }
        let fit = fit(&found);
        assert!((fit.dimension - dimension).abs() < 0.05, "{fit:?}");
        assert!((fit.prefactor - 1.3).abs() < 0.1, "{fit:?}");
    }
}

#[test]
fn scatter_of_the_radius_is_in_the_error() {
    // ln R has a standard deviation of 0.1, as for real agglomerates.
    let mut inside = 0;
    for trial in 0..40 {
        let mut generator = random_of(2, trial, "scatter");
        let mut found = Vec::new();
        for _ in 0..200 {
            let members = (15.0 * libm::exp(4.0 * uniform(&mut generator))) as u64;
            let ratio = libm::pow(members as f64 / 1.2, 1.0 / 1.9);
            let radius_of_gyration = ratio * libm::exp(0.1 * normal(&mut generator));
            let volume = members as f64 * 4.0 / 3.0 * std::f64::consts::PI;
            found.push(Agglomerate { members, volume, radius_of_gyration, ..Default::default() });
        }
        let fit = fit(&found);
        assert!((0.015..0.03).contains(&fit.error), "{fit:?}");
        inside += u32::from((fit.dimension - 1.9).abs() < 1.96 * fit.error);
    }
    assert!(inside >= 33, "{inside} of 40"); // 38 expected, standard deviation 1.4
}

/// Spheres of radius 1 on a simple cubic lattice in a rod, a disc or a ball.
fn compact(dimension: usize, radius: i32) -> Cluster {
    let side = |axis: usize| if axis < dimension { -radius..=radius } else { 0..=0 };
    let mut cluster = Vec::new();
    for x in side(0) {
        for y in side(1) {
            for z in side(2) {
                if x * x + y * y + z * z <= radius * radius {
                    cluster.push(2.0 * Vector3::new(f64::from(x), f64::from(y), f64::from(z)));
                }
            }
        }
    }
    cluster
}

#[test]
fn rods_discs_and_balls_have_their_dimensions() {
    for (dimension, radii) in [(1, [40, 80, 160]), (2, [15, 25, 40]), (3, [8, 12, 16])] {
        let clusters = radii.map(|radius| compact(dimension, radius));
        let population = fit(&clusters.each_ref().map(agglomerate));
        assert!((population.dimension - dimension as f64).abs() < 0.05, "{population:?}");
        let single = MassRadius::of(&clusters[2], 1.0).unwrap();
        assert!((single.dimension - dimension as f64).abs() < 0.05, "{single:?}");
    }
}

/// A three-dimensional Vicsek snowflake: seven copies at three times the scale, dimension ln 7 / ln 3 = 1.771.
fn snowflake(generations: u32) -> Cluster {
    let mut cluster = vec![Vector3::zeros()];
    let mut scale = 2.0;
    for _ in 0..generations {
        let shifts = (0..3).flat_map(|axis| [-1.0, 1.0].map(|sign| (axis, sign)));
        let shifts = shifts.map(|(axis, sign)| {
            let mut shift = Vector3::zeros();
            shift[axis] = sign * scale;
            shift
        });
        let copies =
            shifts.flat_map(|shift| cluster.iter().map(move |x| x + shift).collect::<Vec<_>>());
        let copies: Cluster = copies.collect();
        cluster.extend(copies);
        scale *= 3.0;
    }
    cluster
}

#[test]
fn single_aggregates_of_known_dimension() {
    let flake = MassRadius::of(&snowflake(5), 1.0).unwrap();
    assert!((flake.dimension - 1.771).abs() < 0.05, "{flake:?}");
    let mut means = Vec::new();
    for dimension in [1.8, 2.1] {
        let singles = (0..12).map(|trial| {
            let mut generator = random_of(5, trial, "single");
            let cluster = aggregate(7, (1.3, dimension), &mut generator);
            MassRadius::of(&cluster, 1.0).unwrap().dimension
        });
        let found = SampleMean::of(&singles.collect::<Vec<_>>()).unwrap();
        assert!((found.mean.value - dimension).abs() < 0.05 + 2.0 * found.mean.error, "{found:?}");
        means.push(found);
    }
    // Control: the two differ by many errors.
    let error = means[0].mean.error.hypot(means[1].mean.error);
    assert!(means[1].mean.value - means[0].mean.value > 4.0 * error, "{means:?}");
}

#[test]
fn what_is_too_small_has_no_dimension() {
    assert_eq!(MassRadius::of(&compact(3, 1), 1.0), None);
    assert_eq!(MassRadius::of(&[Vector3::zeros()], 1.0), None);
    let one = [Agglomerate { members: 1, volume: 1.0, ..Default::default() }];
    run_on_threads(1, |ranks| assert_eq!(PopulationFit::of(&one, ranks), None));
}
