//! A picture of a part of the mesh: cells coloured by shape, lines over them.
//!
//! Cells smaller than [`STROKED_PX`] are not stroked (their edges would be one grey), those smaller
//! than [`BINNED_PX`] only colour the pixel under their centre: ten million cells cost a fraction of
//! a second that way, and the picture says the same.

use crate::geometry::point::Xy;
use crate::geometry::quad;
use tiny_skia::Color;
use tiny_skia::Paint;
use tiny_skia::PathBuilder;
use tiny_skia::Pixmap;
use tiny_skia::Stroke;
use tiny_skia::Transform;

/// Cells narrower than this are drawn as their centre pixel, pixels.
const BINNED_PX: f64 = 1.5;

/// Cells narrower than this are filled but not outlined, pixels.
const STROKED_PX: f64 = 5.0;

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// A constraint line as meshed.
    Line,
    /// The rim of the domain.
    Rim,
    /// A seam.
    Seam,
    /// The line work as read, under the mesh.
    Source,
}

/// A picture in the making.
pub struct Picture {
    pixels: Pixmap,
    centre_m: Xy,
    scale: f64,
}

impl Picture {
    /// An empty picture of `width` x `height` pixels that shows at least `span_m` (metres east-west
    /// and north-south) around `centre_m`.
    pub fn new(centre_m: Xy, span_m: Xy, width: u32, height: u32) -> Picture {
        let mut pixels = Pixmap::new(width.max(1), height.max(1)).expect("a picture has pixels");
        pixels.fill(Color::WHITE);
        let scale = (f64::from(width) / span_m[0]).min(f64::from(height) / span_m[1]);
        Picture {
            pixels,
            centre_m,
            scale,
        }
    }

    /// Where `p` falls, pixels from the upper left corner.
    fn place(&self, p: Xy) -> (f32, f32) {
        let (w, h) = (
            f64::from(self.pixels.width()),
            f64::from(self.pixels.height()),
        );
        let x = 0.5 * w + (p[0] - self.centre_m[0]) * self.scale;
        let y = 0.5 * h - (p[1] - self.centre_m[1]) * self.scale;
        (x as f32, y as f32)
    }

    /// True if a part of the box from `low` to `high` may be seen.
    pub fn sees(&self, low: Xy, high: Xy) -> bool {
        let (x0, y1) = self.place(low);
        let (x1, y0) = self.place(high);
        x1 >= 0.0
            && y1 >= 0.0
            && x0 <= self.pixels.width() as f32
            && y0 <= self.pixels.height() as f32
    }

    /// Draws a cell, coloured by its scaled Jacobian.
    pub fn cell(&mut self, p: &[Xy; 4]) {
        let low = [0, 1].map(|k| p.iter().map(|it| it[k]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|k| p.iter().map(|it| it[k]).fold(f64::NEG_INFINITY, f64::max));
        if !self.sees(low, high) {
            return;
        }
        let color = colour(quad::scaled_jacobian(p));
        let across_px = (high[0] - low[0]).max(high[1] - low[1]) * self.scale;
        if across_px < BINNED_PX {
            let (x, y) = self.place([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])]);
            self.dot(x, y, color);
            return;
        }
        let mut path = PathBuilder::new();
        for (k, &corner) in p.iter().enumerate() {
            let (x, y) = self.place(corner);
            if k == 0 {
                path.move_to(x, y)
            } else {
                path.line_to(x, y)
            }
        }
        path.close();
        let Some(path) = path.finish() else { return };
        let rule = tiny_skia::FillRule::Winding;
        let plain = Transform::identity();
        self.pixels
            .fill_path(&path, &paint(color, true), rule, plain, None);
        if across_px >= STROKED_PX {
            let grey = Color::from_rgba8(60, 70, 80, 150);
            let thin = Stroke {
                width: 0.6,
                ..Stroke::default()
            };
            self.pixels
                .stroke_path(&path, &paint(grey, true), &thin, plain, None);
        }
    }

    fn dot(&mut self, x: f32, y: f32, color: Color) {
        let (width, height) = (self.pixels.width(), self.pixels.height());
        if x < 0.0 || y < 0.0 || x >= width as f32 || y >= height as f32 {
            return;
        }
        let at = y as usize * width as usize + x as usize;
        self.pixels.pixels_mut()[at] = color.premultiply().to_color_u8();
    }

    /// Draws a line.
    pub fn line(&mut self, points: &[Xy], ink: Ink) {
        let mut path = PathBuilder::new();
        for (k, &p) in points.iter().enumerate() {
            let (x, y) = self.place(p);
            if k == 0 {
                path.move_to(x, y)
            } else {
                path.line_to(x, y)
            }
        }
        let (color, width) = match ink {
            Ink::Line => (Color::from_rgba8(20, 60, 150, 255), 1.6),
            Ink::Rim => (Color::from_rgba8(10, 10, 10, 255), 2.0),
            Ink::Seam => (Color::from_rgba8(170, 80, 190, 255), 1.0),
            Ink::Source => (Color::from_rgba8(230, 120, 20, 200), 1.0),
        };
        let stroke = Stroke {
            width,
            ..Stroke::default()
        };
        if let Some(path) = path.finish() {
            let plain = Transform::identity();
            self.pixels
                .stroke_path(&path, &paint(color, true), &stroke, plain, None);
        }
    }

    /// Marks a place with a ring.
    pub fn ring(&mut self, at: Xy, radius_px: f32) {
        let (x, y) = self.place(at);
        let Some(path) = PathBuilder::from_circle(x, y, radius_px) else {
            return;
        };
        let red = Color::from_rgba8(220, 20, 30, 255);
        let stroke = Stroke {
            width: 2.0,
            ..Stroke::default()
        };
        self.pixels.stroke_path(
            &path,
            &paint(red, true),
            &stroke,
            Transform::identity(),
            None,
        );
    }

    /// The picture as PNG.
    pub fn png(&self) -> Vec<u8> {
        self.pixels
            .encode_png()
            .expect("PNG encoding in memory cannot fail")
    }

    /// Several pictures of one size in one, `columns` beside each other, as PNG.
    pub fn sheet_png(pictures: &[Picture], columns: u32) -> Vec<u8> {
        let (w, h) = (pictures[0].pixels.width(), pictures[0].pixels.height());
        let rows = (pictures.len() as u32).div_ceil(columns);
        let gap = 8;
        let (width, height) = (columns * (w + gap) - gap, rows * (h + gap) - gap);
        let mut sheet = Pixmap::new(width, height).expect("a sheet has pixels");
        sheet.fill(Color::from_rgba8(120, 120, 120, 255));
        for (n, picture) in pictures.iter().enumerate() {
            let x = (n as u32 % columns) * (w + gap);
            let y = (n as u32 / columns) * (h + gap);
            let paint = tiny_skia::PixmapPaint::default();
            let plain = Transform::identity();
            sheet.draw_pixmap(
                x as i32,
                y as i32,
                picture.pixels.as_ref(),
                &paint,
                plain,
                None,
            );
        }
        sheet
            .encode_png()
            .expect("PNG encoding in memory cannot fail")
    }
}

/// White-green for squares, yellow below 0.7, red below 0.3: the eye finds red first.
fn colour(scaled_jacobian: f64) -> Color {
    let stops = [
        (0.0, [150, 0, 30]),
        (0.3, [225, 60, 40]),
        (0.6, [250, 190, 70]),
        (0.8, [225, 235, 150]),
        (0.95, [190, 225, 200]),
        (1.0, [222, 238, 234]),
    ];
    let s = scaled_jacobian.clamp(0.0, 1.0);
    let k = (1..stops.len() - 1)
        .find(|&k| s < stops[k].0)
        .unwrap_or(stops.len() - 1);
    let ((s0, c0), (s1, c1)) = (stops[k - 1], stops[k]);
    let t = (s - s0) / (s1 - s0);
    let mix = |n: usize| (f64::from(c0[n]) + t * f64::from(c1[n] - c0[n])).round() as u8;
    Color::from_rgba8(mix(0), mix(1), mix(2), 255)
}

fn paint(color: Color, smooth: bool) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: smooth,
        ..Paint::default()
    };
    paint.set_color(color);
    paint
}
