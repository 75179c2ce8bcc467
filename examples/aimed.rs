//! Prints the table of the aimed tests, or the rows whose name holds a word:
//! `cargo run --release --example aimed [-- WORD]`.

#[path = "../tests/aimed/course.rs"]
mod course;

use course::{
    Ride, corner, crossing, doorway, grazing, spinning, tally, tight, weaving, with_exact_rays,
};

fn main() {
    let corners = [-0.25, 0.25];
    let front = [-0.2, -0.1, 0.0, 0.1, 0.2];
    let courses: [(&str, Vec<Ride>); 13] = [
        ("body corner at a box corner, it echoes (0.7)", corner(&corners, 0.7, 12)),
        ("the same, it does not", corner(&corners, 0.0, 12)),
        ("front edge at a box corner, it echoes (0.7)", corner(&front, 0.7, 6)),
        ("the same, it does not", corner(&front, 0.0, 6)),
        ("grazing a wall", grazing(24)),
        ("spinning beside a wall", spinning(24)),
        ("weaving beside a wall", weaving(24)),
        ("tight starts", tight(600)),
        ("doorway of 0.6 m", doorway(16)),
        ("a person crossing", crossing(18)),
        ("tight starts, exact rays", with_exact_rays(tight(150))),
        ("doorway of 0.6 m, exact rays", with_exact_rays(doorway(16))),
        ("a person crossing, exact rays", with_exact_rays(crossing(18))),
    ];
    println!(
        "| course | version | rides | touched | % | deepest, mm | ran into a person (mm/s) | passed |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let only = std::env::args().nth(1).unwrap_or_default();
    for (name, rides) in courses.iter().filter(|(name, _)| name.contains(&only)) {
        for version in ["human", "tandem-kinematic", "tandem-dynamic"] {
            let tally = tally(rides, version);
            println!(
                "| {name} | `{version}` | {} | {} | {:.1} | {:.0} | {} ({:.0}) | {} |",
                tally.runs,
                tally.touched,
                100.0 * tally.touched as f64 / tally.runs as f64,
                1000.0 * tally.deepest_m,
                tally.ran_into,
                1000.0 * tally.towards_mps,
                tally.passed
            );
        }
    }
}
