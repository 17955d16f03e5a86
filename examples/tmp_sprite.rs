use haze::sprite::bake::*;
fn main() {
    let recipe: SpriteRecipe =
        serde_json::from_str(&std::fs::read_to_string(std::env::args().nth(1).unwrap()).unwrap()).unwrap();
    let t = std::time::Instant::now();
    let sheet = recipe.bake().unwrap();
    eprintln!("{:?}", t.elapsed());
    // preview: normal, alpha, lit
    let (w, h) = sheet.dimensions();
    let mut out = image::RgbImage::new(w * 2, h * 2);
    for y in 0..h {
        for x in 0..w {
            let p = sheet.get_pixel(x, y).0;
            let a = p[3] as f32 / 255.;
            let n = glam::Vec3::new(p[0] as f32, p[1] as f32, p[2] as f32) / 127.5 - 1.0;
            let l = glam::Vec3::new(0.7, 0.5, 0.4).normalize();
            let d = (n.dot(l) * 0.5 + 0.5).powf(1.5);
            let c = |v: f32| (v.clamp(0., 1.) * 255.) as u8;
            out.put_pixel(x, y, image::Rgb([p[0], p[1], p[2]]));
            out.put_pixel(x + w, y, image::Rgb([p[3], p[3], p[3]]));
            let bg = 0.12;
            let lit = bg * (1. - a) + d * a;
            out.put_pixel(x, y + h, image::Rgb([c(lit), c(lit), c(lit)]));
            let a2 = (a * 0.25);
            let lit = bg * (1. - a2) + d * a2;
            out.put_pixel(x + w, y + h, image::Rgb([c(lit), c(lit), c(lit)]));
        }
    }
    out.save(std::env::args().nth(2).unwrap()).unwrap();
    sheet.save("/tmp/try/sheet.png").unwrap();
    eprintln!("{}", std::fs::metadata("/tmp/try/sheet.png").unwrap().len());
}
