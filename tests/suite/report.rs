//! Tests of `report`.

use polder::report::html::html;
use polder::report::page::Histogram;
use polder::report::page::Page;
use polder::report::page::Plate;
use polder::report::page::Table;
use polder::report::picture::Ink;
use polder::report::picture::Picture;

#[test]
fn a_picture_shows_a_bad_cell_in_red_and_a_square_in_pale_green() {
    let mut picture = Picture::new([0.0, 0.0], [4.0, 2.0], 80, 40);
    picture.cell(&[[-2.0, -1.0], [0.0, -1.0], [0.0, 1.0], [-2.0, 1.0]]);
    picture.cell(&[[0.0, -1.0], [2.0, -1.0], [0.7, -0.4], [0.0, 1.0]]);
    let decoded = tiny_skia::Pixmap::decode_png(&picture.png()).unwrap();
    let pixel = |x, y| decoded.pixel(x, y).unwrap();
    assert!(pixel(20, 20).green() > 200, "the square");
    assert!(
        pixel(44, 34).red() > 120 && pixel(44, 34).green() < 90,
        "the dart"
    );
    assert_eq!(pixel(78, 2).green(), 255, "outside stays white");
}

#[test]
fn cells_below_a_pixel_still_show() {
    let mut picture = Picture::new([0.0, 0.0], [1000.0, 1000.0], 100, 100);
    picture.cell(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    picture.line(&[[-400.0, 0.0], [-300.0, 100.0]], Ink::Line);
    let decoded = tiny_skia::Pixmap::decode_png(&picture.png()).unwrap();
    let painted = decoded.pixels().iter().filter(|it| it.red() < 250).count();
    assert!(painted > 5, "{painted}");
}

#[test]
fn a_page_is_complete_in_itself_and_escapes_names() {
    let page = Page {
        title: "a <b> city".into(),
        verdict: "every promise holds".into(),
        holds: true,
        plates: vec![Plate {
            caption: "whole".into(),
            png: vec![1, 2, 3, 4],
        }],
        histograms: vec![Histogram {
            title: "sj".into(),
            from: 0.0,
            to: 1.0,
            counts: vec![1, 4, 9],
        }],
        tables: vec![Table {
            title: "worst".into(),
            note: String::new(),
            head: vec!["x".into()],
            rows: vec![vec!["\"5\" & <6>".into()]],
        }],
    };
    let text = html(&page);
    assert!(text.contains("a &lt;b&gt; city") && text.contains("&quot;5&quot; &amp; &lt;6&gt;"));
    assert!(text.contains("data:image/png;base64,AQIDBA=="));
    assert!(!text.contains("http"), "nothing is fetched");
}
