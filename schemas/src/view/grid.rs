//! `/map`: what is known of a room that was mapped from a log.

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{Color, Grid, PackedElementField, Vector2};

use super::frames::WORLD;
use super::primitives::{colour, pose, timestamp};
use crate::{Cell, Explored, Pose, Time};

/// The grid with a colour for each cell; what is unknown is not drawn.
pub(super) fn grid(at: Time, explored: &Explored) -> Grid {
    let columns = explored.rows.first().map_or(0, String::len);
    let channels = ["red", "green", "blue", "alpha"];
    let field = |(offset, name): (usize, &str)| PackedElementField {
        name: name.to_owned(),
        offset: offset as u32,
        r#type: NumericType::Uint8 as i32,
    };
    let [x_m, y_m] = explored.low_m;
    Grid {
        timestamp: Some(timestamp(at)),
        frame_id: WORLD.to_owned(),
        // A little below the floor, so that everything else is drawn over it.
        pose: Some(pose(&Pose { x_m, y_m, theta_rad: 0.0 }, -0.01)),
        column_count: columns as u32,
        cell_size: Some(Vector2 { x: explored.cell_m, y: explored.cell_m }),
        row_stride: (columns * channels.len()) as u32,
        cell_stride: channels.len() as u32,
        fields: channels.into_iter().enumerate().map(field).collect(),
        data: explored.cells().flat_map(|(_, cell)| colour_of(cell)).collect::<Vec<u8>>().into(),
    }
}

fn colour_of(cell: Cell) -> [u8; 4] {
    let Color { r, g, b, a } = match cell {
        Cell::Unknown => colour::faded(colour::UNKNOWN, 0.0),
        Cell::Free => colour::faded(colour::ECHO, 0.25),
        Cell::Taken => colour::SOLID,
    };
    // `as` saturates.
    [r, g, b, a].map(|share| (share * 255.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of three cells, from the lowest row up, four bytes each.
    #[test]
    fn every_cell_has_its_colour() {
        use Cell::{Free, Taken, Unknown};
        let cells = [Free, Taken, Unknown, Unknown, Free, Taken];
        let grid = grid(Time(7), &Explored::new([-1.0, 2.0], 0.5, 3, &cells));
        assert_eq!((grid.column_count, grid.row_stride, grid.cell_stride), (3, 12, 4));
        assert_eq!(grid.data.len(), 24);
        let alpha: Vec<bool> = grid.data.chunks(4).map(|cell| cell[3] > 0).collect();
        assert_eq!(alpha, [true, true, false, false, true, true]);
        assert_eq!(grid.data[0..4], grid.data[16..20]);
        assert_eq!(grid.data[4..8], grid.data[20..24]);
        assert_ne!(grid.data[0..4], grid.data[4..8]);
        let corner = grid.pose.and_then(|pose| pose.position).expect("placed");
        assert_eq!((corner.x, corner.y), (-1.0, 2.0));
    }
}
