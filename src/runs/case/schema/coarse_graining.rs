//! `[coarse_graining]`.

use super::Chapter;
use talcum_engine::contact::COARSE_GRAINING;

pub(super) const CHAPTER: Chapter = Chapter {
    path: "coarse_graining",
    title: "parcels in place of particles",
    keys: COARSE_GRAINING,
    before: "\
The bodies of the run are parcels, each l times as large as the particles that the case describes, and as heavy as l^3 of
them. All other keys speak of the particles: their diameter, their number (of which l^3 make a parcel), Bond and Stokes number,
stiffness. Beds from files are refused; a bed that is the end of another run must be of parcels of the same factor.",
    after: "\
With l the factor:

| quantity | of a parcel over that of a particle |
| --- | --- |
| diameter, least distance at the start | l |
| mass | l^3 |
| velocity, restitution, friction | 1 |
| forces of contact and adhesion at l times the overlap or separation | `strength`: l^2; `bond_number`: l^3 |
| stiffnesses, surface energy | `strength`: l; `bond_number`: l^2 |
| Young's modulus | `strength`: 1; `bond_number`: l |
| Hamaker constant | `strength`: l^3; `bond_number`: l^4 |
| range and cut-off of attraction, radius of asperities, diameter of primary particles | l |
| duration of a contact | `strength`: l; `bond_number`: l^(1/2) |
| drag | l^3 times that of a particle at the same velocities and voidage |

`time.step` stays as it is given: it may be as much longer as contacts last. `talcum check` and all results describe parcels. No rule keeps everything: see
docs/how-to/parcels.md for what a bed keeps at factors 2 and 4.",
};
