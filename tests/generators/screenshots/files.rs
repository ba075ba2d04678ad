//! Picture files, small: colours of a palette where few are enough.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use image::RgbImage;
use png::{ColorType, Compression, Encoder, Filter};
use tautline_session::write_bytes;

/// Colours of a palette.
const COLOURS: usize = 256;
/// Number of time units of a frame in a second.
const TENTHS: u16 = 10;

/// A frame of an animation with its duration.
pub struct Frame {
    /// The picture.
    pub picture: RgbImage,
    /// Duration (tenths of a second).
    pub tenths: u16,
}

/// Writes a picture.
pub fn write_still(path: &Path, picture: &RgbImage) -> Result<()> {
    let frames = [Frame {
        picture: picture.clone(),
        tenths: 0,
    }];
    write(path, &frames)
}

/// Writes an animation that is repeated for ever.
pub fn write(path: &Path, frames: &[Frame]) -> Result<()> {
    let Some(first) = frames.first() else {
        return Ok(());
    };
    let palette = Palette::of(frames);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, first.picture.width(), first.picture.height());
    encoder.set_color(ColorType::Indexed);
    encoder.set_palette(palette.bytes());
    encoder.set_compression(Compression::High);
    encoder.set_filter(Filter::NoFilter);
    if frames.len() > 1 {
        encoder.set_animated(u32::try_from(frames.len())?, 0)?;
    }
    let mut writer = encoder.write_header()?;
    for frame in frames {
        if frames.len() > 1 {
            writer.set_frame_delay(frame.tenths, TENTHS)?;
        }
        writer.write_image_data(&palette.indices(&frame.picture))?;
    }
    writer.finish()?;
    write_bytes(path, &bytes)?;
    Ok(())
}

/// The most frequent colours, those that are alike counted together.
struct Palette(Vec<[u8; 3]>);

impl Palette {
    fn of(frames: &[Frame]) -> Self {
        let mut counts = BTreeMap::<[u8; 3], usize>::new();
        for pixel in frames.iter().flat_map(|frame| frame.picture.pixels()) {
            *counts.entry(pixel.0).or_default() += 1;
        }
        let mut cells = vec![Cell(counts.into_iter().collect())];
        while cells.len() < COLOURS {
            let widest =
                (0..cells.len()).max_by(|a, b| cells[*a].cost().total_cmp(&cells[*b].cost()));
            let Some(at) = widest.filter(|at| cells[*at].cost() > 0.0) else {
                break;
            };
            let (one, other) = cells.swap_remove(at).halves();
            cells.extend([one, other]);
        }
        Self(cells.iter().map(Cell::middle).collect())
    }

    fn bytes(&self) -> Vec<u8> {
        self.0.concat()
    }

    /// The nearest colour of each pixel.
    fn indices(&self, picture: &RgbImage) -> Vec<u8> {
        let mut known = BTreeMap::<[u8; 3], u8>::new();
        let nearest = |colour: [u8; 3]| {
            let distances = self.0.iter().map(|c| distance(*c, colour));
            let least = distances.enumerate().min_by_key(|(_, d)| *d);
            least.map_or(0, |(index, _)| index as u8)
        };
        let pixels = picture.pixels();
        pixels
            .map(|pixel| *known.entry(pixel.0).or_insert_with(|| nearest(pixel.0)))
            .collect()
    }
}

fn distance(a: [u8; 3], b: [u8; 3]) -> i32 {
    (0..3)
        .map(|k| (i32::from(a[k]) - i32::from(b[k])).pow(2))
        .sum()
}

/// Colours with how often they occur, to be shown as one.
struct Cell(Vec<([u8; 3], usize)>);

impl Cell {
    fn weight(&self) -> f64 {
        self.0.iter().map(|(_, count)| *count as f64).sum()
    }

    fn mean(&self, channel: usize) -> f64 {
        let sum: f64 = (self.0.iter())
            .map(|(colour, count)| f64::from(colour[channel]) * *count as f64)
            .sum();
        sum / self.weight()
    }

    /// Sum of squares about the mean, damped so that rare colours, of cables and marks, get places of their own.
    fn spread(&self, channel: usize) -> f64 {
        let mean = self.mean(channel);
        let square = |(colour, count): &([u8; 3], usize)| {
            (f64::from(colour[channel]) - mean).powi(2) * (*count as f64).sqrt()
        };
        self.0.iter().map(square).sum()
    }

    fn cost(&self) -> f64 {
        (0..3).map(|channel| self.spread(channel)).sum()
    }

    fn middle(&self) -> [u8; 3] {
        // The most frequent one, if it is most of them: plain areas keep their exact colour.
        let most = self.0.iter().max_by_key(|(_, count)| *count);
        match most {
            Some((colour, count)) if *count as f64 > 0.5 * self.weight() => *colour,
            _ => [0, 1, 2].map(|channel| self.mean(channel).round() as u8),
        }
    }

    /// Cut at the mean of the channel that varies most.
    fn halves(mut self) -> (Self, Self) {
        let channel = (0..3).max_by(|a, b| self.spread(*a).total_cmp(&self.spread(*b)));
        let channel = channel.unwrap_or_default();
        let mean = self.mean(channel);
        self.0.sort_by_key(|(colour, _)| colour[channel]);
        let below = self
            .0
            .partition_point(|(colour, _)| f64::from(colour[channel]) <= mean);
        let at = below.clamp(1, self.0.len() - 1);
        let above = self.0.split_off(at);
        (self, Self(above))
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    #[test]
    fn few_colours_are_kept_exactly_and_frames_are_read_again() {
        let first = RgbImage::from_fn(40, 30, |x, y| Rgb([x as u8, 200, (y % 3) as u8]));
        let second = RgbImage::from_fn(40, 30, |x, y| Rgb([x as u8, 200, (y % 2) as u8]));
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("two.png");
        let frames = [first.clone(), second.clone()].map(|picture| Frame { picture, tenths: 5 });
        write(&path, &frames).expect("written");
        let file = std::io::BufReader::new(std::fs::File::open(&path).expect("a file"));
        let mut decoder = png::Decoder::new(file);
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().expect("a picture");
        assert_eq!(
            reader.info().animation_control.map(|a| a.num_frames),
            Some(2)
        );
        for expected in [first, second] {
            let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
            reader.next_frame(&mut bytes).expect("a frame");
            assert_eq!(bytes, expected.into_raw());
        }
    }
}
