use super::*;
use crate::formula::curve::smoothstep_unit;
use crate::formula::flight::drag_integrals;
use crate::frame::{EmitterPaths, SpriteExtent, particle_bounds};
use crate::settings::Settings;

fn at(emitter: &Emitter, time: f64) -> Vec<Particle> {
    let mut particles = Vec::new();
    emitter.evaluate(time, &mut particles);
    particles
}

#[test]
fn particles_do_not_depend_on_earlier_evaluations() {
    let emitter = Emitter::default();
    let later = at(&emitter, 30.0);
    assert_eq!(later, at(&emitter, 30.0));
    let _ = at(&emitter, 1.0);
    assert_eq!(later, at(&emitter, 30.0));
    assert!(later.iter().all(Particle::is_valid));
    // Rate times lifetime, within the jitter.
    assert!((200..=280).contains(&later.len()), "{}", later.len());
}

#[test]
fn extreme_seeds_give_smoke_too() {
    // The second seed times 977 wraps to the largest word.
    for seed in [0, 769_313_487, u32::MAX] {
        assert!(at(&Emitter { seed, ..Emitter::default() }, 2.0).len() > 50);
    }
}

#[test]
fn motion_is_continuous() {
    let emitter = Emitter { lifetime_spread: 0.0, ..Emitter::default() };
    let before = at(&emitter, 12.0);
    let after = at(&emitter, 12.001);
    let mut matched = 0;
    for a in &before {
        // A millisecond moves a particle by millimetres; its neighbours are further away.
        let nearest = after.iter().map(|b| a.position.distance(b.position)).fold(f32::INFINITY, f32::min);
        assert!(nearest < 0.02 || a.age > 0.999, "{nearest}");
        matched += 1;
    }
    assert!(matched > 100);
}

#[test]
fn smoke_rises_along_up() {
    let upwards = Emitter { shape: EmitterShape::Disc, turbulence: 0.0, ..Emitter::default() };
    // Cycles the axes: x becomes y, y becomes z, z becomes x.
    let turned = |v: Vec3| Vec3::new(v.z, v.x, v.y);
    let along_z = Emitter { up: Vec3::Z * 3.0, velocity: turned(upwards.velocity), velocity_spread: 0.0, ..upwards };
    let upwards = Emitter { velocity_spread: 0.0, ..upwards };
    let height = |particles: &[Particle], up: Vec3| particles.iter().map(|p| p.position.dot(up)).sum::<f32>();
    let y = height(&at(&upwards, 9.0), Vec3::Y);
    let z = height(&at(&along_z, 9.0), Vec3::Z);
    assert!((y - z).abs() < 1e-3 * y, "{y} {z}");
    assert!(Emitter { up: Vec3::ZERO, ..upwards }.validate(String::new).is_err());
}

#[test]
fn births_and_deaths_are_invisible() {
    for particle in at(&Emitter::default(), 20.0) {
        assert!(particle.amount <= 0.3 * smoothstep_unit(particle.age / 0.12) + 1e-6);
        assert!(particle.age < 0.98 || particle.amount < 0.01);
    }
}

#[test]
fn smoke_ends_after_emission_has_ended() {
    let emitter = Emitter { duration: 0.5, rate: 100.0, ..Emitter::default() };
    assert!(at(&emitter, -1.0).is_empty());
    assert!((48..=50).contains(&at(&emitter, 0.6).len()));
    assert!(at(&emitter, 60.0).is_empty());
}

#[test]
fn drag_integrals_are_continuous_where_the_series_takes_over() {
    for t in [0.1, 1.0, 10.0] {
        let series = drag_integrals(0.499_999 / t, t);
        let closed = drag_integrals(0.500_001 / t, t);
        assert!((series.x - closed.x).abs() < 2e-6 * t && (series.y - closed.y).abs() < 2e-6 * t * t);
    }
}

/// Emitters of all kinds.
fn emitters() -> impl Iterator<Item = Emitter> {
    let base = Emitter { rate: 400.0, ..Emitter::default() };
    [
        base,
        Emitter { shape: EmitterShape::Disc, up: Vec3::new(1.0, 2.0, 0.3), extent: Vec3::new(2.0, 0.0, 1.0), ..base },
        Emitter { shape: EmitterShape::Box, wind: Vec3::new(3.0, 0.0, -1.0), drag: 4.0, ..base },
        Emitter { burst: 8.0, duration: 0.1, drag: 2.0, velocity: Vec3::ZERO, ..base },
        Emitter { burst: -3.0, turbulence: 4.0, turbulence_scale: 0.3, drag: 0.0, buoyancy: -2.0, ..base },
        Emitter { radius_start: 2.0, radius_end: 0.1, lifetime_spread: 0.9, velocity_spread: 5.0, ..base },
        Emitter { duration: 0.3, period: 0.7, rate_curve: "0:1,1:0".parse().unwrap(), ..base },
        Emitter { anchor: 1.0, radius_end: 0.0, radius_start: 2.0, rotation_spread: 0.0, ..base },
        Emitter {
            velocity: Vec3::new(4.0, 1.0, 0.0),
            speed_curve: "0:3,0.3:0.2,0.9:1".parse().unwrap(),
            size_curve: "0:0,0.4:2.5,1:0.1".parse().unwrap(),
            ..base
        },
        Emitter {
            bounce: 0.6,
            floor: -0.4,
            velocity: Vec3::new(-1.0, 3.0, 0.5),
            wind: Vec3::new(2.0, 0.0, 0.0),
            buoyancy: -9.8,
            drag: 0.3,
            ..base
        },
        Emitter { ring_speed: 1.5, ring_rate: 0.8, wind: Vec3::X, ..base },
        Emitter {
            ring_speed: 4.0,
            ring_size: 1.0,
            shape: EmitterShape::Disc,
            turbulence: 0.0,
            velocity: Vec3::Z,
            ..base
        },
        Emitter { wind_shear: Vec3::new(0.5, 2.0, -0.2), small_fraction: 0.4, small_size: 0.2, ..base },
        Emitter { orbit: -0.4, wind: Vec3::new(0.5, 0.0, 1.0), extent: Vec3::splat(1.0), ..base },
        Emitter { attraction: 1.5, attractor: Vec3::new(1.0, 2.0, 0.0), ring_speed: 0.5, ..base },
        Emitter { floor_margin: 0.6, floor: -0.5, buoyancy: -1.5, wind: Vec3::Z, orbit: 0.1, ..base },
        Emitter {
            obstacle_margin: 0.5,
            obstacle: Vec3::new(0.2, 1.5, 0.0),
            obstacle_extent: Vec3::new(1.0, 0.2, 0.6),
            ..base
        },
        Emitter { obstacle_margin: 0.3, obstacle: base.position, velocity: Vec3::X, wind: Vec3::Z, ..base },
        Emitter { attraction: -0.8, attractor: Vec3::new(0.1, 1.0, 0.0), size: 3.0, orbit: 0.2, ..base },
    ]
    .into_iter()
}

#[test]
fn motion_is_as_even_after_hours_as_at_first() {
    let emitter = Emitter { turbulence: 0.0, frame_rate: 0.0, drag: 0.0, velocity: Vec3::Y, ..Emitter::default() };
    let emitter = Emitter { velocity_spread: 0.0, buoyancy: 0.0, wind: Vec3::ZERO, ..emitter };
    let rise = 1.0 / 60.0;
    let hours_in = 10_000.0;
    for frame in 0..30 {
        let time = hours_in + f64::from(frame) / 60.0;
        let before = at(&emitter, time);
        let now = at(&emitter, time + 1.0 / 60.0);
        let find = |a: &Particle| now.iter().find(|b| b.frame.to_bits() == a.frame.to_bits());
        let moved = before.iter().find_map(|a| Some(find(a)?.position - a.position)).unwrap();
        assert!((moved.y - rise).abs() < 0.01 * rise, "{moved} in frame {frame}");
    }
}

#[test]
fn velocity_is_the_change_of_position() {
    // Between bounces, and without growth off an anchor.
    for emitter in emitters().filter(|emitter| emitter.bounce <= 0.0 && emitter.anchor <= 0.0) {
        // Strong swirls amplify the rounding of a path, to a tenth of a millimeter at this strength; a shorter time would divide
        // that.
        let turbulence = emitter.turbulence.min(0.5 * emitter.turbulence_scale);
        let emitter = Emitter { turbulence, frame_rate: 0.0, ..emitter };
        let step = 1.0e-2_f32;
        let before = at(&emitter, 0.9);
        let now = at(&emitter, 0.9 + f64::from(step));
        // A still flipbook frame is another in each particle.
        let pairs =
            before.iter().filter_map(|a| Some((a, now.iter().find(|b| b.frame.to_bits() == a.frame.to_bits())?)));
        let mut count = 0;
        for (a, b) in pairs {
            let velocity = 0.5 * (a.velocity + b.velocity);
            let error = ((b.position - a.position) / step - velocity).length();
            assert!(error < 0.03 * (1.0 + velocity.length()), "{emitter:?}: {error} of {velocity}");
            count += 1;
        }
        assert!(count > 20, "{emitter:?}: {count}");
    }
}

#[test]
fn smoke_of_any_size_moves_alike() {
    for emitter in emitters() {
        // Not what stays where it is, nor births that f32 rounds to another number. Swirls are those of a position: at the
        // origin.
        if emitter.bounce > 0.0 || emitter.attraction != 0.0 || emitter.duration > 0.0 {
            continue;
        }
        if emitter.floor_margin > 0.0 || emitter.obstacle_margin > 0.0 {
            continue;
        }
        let turbulence = emitter.turbulence.min(0.5 * emitter.turbulence_scale);
        let emitter = Emitter { size: 1.0, turbulence, ..emitter };
        let small = at(&emitter, 5.0);
        // Four is a power of two, which rounds nothing.
        let large = at(&Emitter { size: 4.0, ..emitter }, 10.0);
        assert_eq!(small.len(), large.len());
        for (small, large) in small.iter().zip(&large) {
            let expected = small.position * 4.0;
            assert!(expected.distance(large.position) < 1.0e-2, "{emitter:?}: {small:?} {large:?}");
            assert!((small.velocity * 2.0).distance(large.velocity) < 1.0e-2, "{emitter:?}: {small:?} {large:?}");
            assert!((small.radius * 4.0 - large.radius).abs() < 1.0e-4, "{small:?} {large:?}");
            assert!((small.age - large.age).abs() < 1.0e-5 && (small.amount - large.amount).abs() < 1.0e-4);
        }
    }
}

#[test]
fn smoke_turns_about_an_axis_that_the_wind_carries() {
    let emitter =
        Emitter { orbit: 0.25, wind: Vec3::X, drag: 1.0, turbulence: 0.0, lifetime_spread: 0.0, ..Emitter::default() };
    let straight = at(&Emitter { orbit: 0.0, ..emitter }, 9.0);
    for (a, b) in straight.iter().zip(&at(&emitter, 9.0)) {
        let seconds = a.age * emitter.lifetime;
        let axis = Vec3::X * (seconds - 1.0 + (-seconds).exp());
        let expected = axis + Quat::from_rotation_y(TAU * 0.25 * seconds) * (a.position - axis);
        assert!(expected.distance(b.position) < 1.0e-4, "{a:?} {b:?} {expected}");
    }
}

#[test]
fn smoke_is_drawn_to_the_attractor_and_pushed_away() {
    let emitter = Emitter { attractor: Vec3::new(0.5, 2.0, 0.0), turbulence: 0.0, ..Emitter::default() };
    let mean_distance = |attraction: f32| {
        let particles = at(&Emitter { attraction, ..emitter }, 20.0);
        particles.iter().map(|p| p.position.distance(emitter.attractor)).sum::<f32>() / particles.len() as f32
    };
    let distances = [1.0, 0.3, 0.0, -0.3].map(mean_distance);
    assert!(distances.is_sorted(), "{distances:?}");
    assert!(distances[0] < 0.6 * distances[2], "{distances:?}");
}

#[test]
fn smoke_that_falls_flows_along_the_floor() {
    let emitter = Emitter { buoyancy: -1.0, turbulence: 0.3, position: Vec3::Y, lifetime: 8.0, ..Emitter::default() };
    let flowing = at(&Emitter { floor_margin: 0.5, ..emitter }, 20.0);
    let lowest = flowing.iter().map(|p| p.position.y).fold(f32::INFINITY, f32::min);
    assert!(lowest > -0.15, "{lowest}");
    assert!(at(&emitter, 20.0).iter().any(|p| p.position.y < -2.0));
    let aside = |p: &&Particle| p.position.with_y(0.0).length() > 1.0;
    assert!(flowing.iter().filter(aside).count() > flowing.len() / 4);
}

#[test]
fn smoke_flows_around_an_obstacle() {
    let extent = Vec3::new(0.8, 0.1, 0.5);
    let emitter = Emitter {
        obstacle: Vec3::Y * 2.0,
        obstacle_extent: extent,
        turbulence: 0.2,
        lifetime: 8.0,
        rate: 200.0,
        ..Emitter::default()
    };
    let inside = |p: &&Particle| (p.position - emitter.obstacle).abs().cmplt(extent).all();
    let through = at(&emitter, 20.0);
    assert!(through.iter().filter(inside).count() > 20);
    let around = at(&Emitter { obstacle_margin: 0.4, ..emitter }, 20.0);
    let inside = around.iter().filter(inside).count();
    // The steps of a path may cut a corner; none was seen.
    assert!(inside <= around.len() / 200, "{inside} of {}", around.len());
    // It gets past, on both sides.
    for side in [Vec3::X, Vec3::NEG_X] {
        let past = |p: &&Particle| p.position.y > 2.5 && p.position.dot(side) > 0.0;
        assert!(around.iter().filter(past).count() > around.len() / 20, "{side}");
    }
}

#[test]
fn small_particles_have_their_share() {
    let emitter =
        Emitter { small_fraction: 0.3, small_size: 0.25, radius_spread: 0.0, rate: 400.0, ..Emitter::default() };
    let usual = at(&Emitter { small_fraction: 0.0, ..emitter }, 20.0);
    let particles = at(&emitter, 20.0);
    let small = particles.iter().zip(&usual).filter(|(a, b)| (a.radius - 0.25 * b.radius).abs() < 1.0e-6).count();
    let same = particles.iter().zip(&usual).filter(|(a, b)| a == b).count();
    assert_eq!(small + same, particles.len());
    let fraction = small as f32 / particles.len() as f32;
    assert!((fraction - 0.3).abs() < 0.04, "{fraction}");
}

#[test]
fn births_follow_the_curve_of_the_rate() {
    let rising = Emitter {
        rate: 1000.0,
        duration: 1.0,
        period: 2.0,
        rate_curve: "0:0,0.5:0.2,1:1".parse().unwrap(),
        lifetime: 1.0,
        lifetime_spread: 0.0,
        frame_rate: 0.0,
        ..Emitter::default()
    };
    let count = |emitter: &Emitter, time| at(emitter, time).len() as f32;
    // Integral of the curve, within a hundredth of all births.
    for pulse in [0.0, 14.0] {
        assert!((count(&rising, pulse + 0.5) - 50.0).abs() < 10.0, "{}", count(&rising, pulse + 0.5));
        assert!((count(&rising, pulse + 0.999) - 350.0).abs() < 10.0, "{}", count(&rising, pulse + 0.999));
    }
    // One emission, and one without an end, in which there is no position on the curve.
    assert!((count(&Emitter { period: 0.0, ..rising }, 0.999) - 350.0).abs() < 10.0);
    let endless = Emitter { period: 0.0, duration: 0.0, ..rising };
    assert_eq!(at(&endless, 3.0), at(&Emitter { rate_curve: Curve::constant(1.0), ..endless }, 3.0));
    // A birth is the same whether others happen or not.
    let all = at(&Emitter { rate_curve: Curve::constant(1.0), ..rising }, 0.9);
    assert!(at(&rising, 0.9).iter().all(|particle| all.contains(particle)));
    let even = Emitter { rate_curve: Curve::constant(0.25), ..rising };
    let mut births: Vec<f32> = at(&even, 0.999).iter().map(|particle| particle.age).collect();
    births.sort_by(f32::total_cmp);
    let widest = births.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f32::max);
    assert!(widest < 0.007, "every fourth of 1000 births: {widest}");
}

#[test]
fn births_of_long_pulses_keep_their_times() {
    // f32 has no number for every birth after the first 16 million.
    let emitter = Emitter { rate: 20_000.0, duration: 3000.0, period: 3600.0, lifetime: 0.01, ..Emitter::default() };
    let emitter = Emitter { lifetime_spread: 0.0, ..emitter };
    let mut ages: Vec<f32> = at(&emitter, 2999.0).iter().map(|particle| particle.age).collect();
    ages.sort_by(f32::total_cmp);
    // One birth in each of 200 intervals.
    let widest = ages.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f32::max) * 200.0;
    assert!(ages.len() >= 198 && widest < 2.1, "{} {widest}", ages.len());
}

#[test]
fn pulses_repeat_and_each_is_born_in_its_turn() {
    let emitter = Emitter { rate: 100.0, duration: 0.2, period: 1.0, lifetime: 0.5, ..Emitter::default() };
    let emitter = Emitter { lifetime_spread: 0.0, ..emitter };
    let count = |time| at(&emitter, time).len();
    assert_eq!((count(-0.1), count(0.9), count(7.8)), (0, 0, 0));
    assert!((18..=20).contains(&count(0.3)) && (18..=20).contains(&count(7.3)), "{} {}", count(0.3), count(7.3));
    assert!((8..=12).contains(&count(3.1)), "{}", count(3.1));
    // Other random numbers in each pulse.
    assert_ne!(at(&emitter, 0.3)[3].position, at(&emitter, 1.3)[3].position);
    // Long lives: particles of several pulses.
    let long = Emitter { lifetime: 2.7, ..emitter };
    let alive = at(&long, 9.5).len() as f64;
    assert!((54.0..=60.0).contains(&alive) && alive <= long.max_alive(), "{alive} of {}", long.max_alive());
    let error = Emitter { period: 0.1, ..emitter }.validate(|| "e".into()).unwrap_err().to_string();
    assert_eq!(error, "e.period: 0.1 is not valid; expected 0, or at least the duration of 0.2 s");
}

#[test]
fn particles_bounce_off_the_floor_and_come_to_rest() {
    let emitter = Emitter {
        bounce: 0.5,
        buoyancy: -9.81,
        drag: 0.0,
        extent: Vec3::ZERO,
        velocity: Vec3::new(1.0, 0.0, 0.0),
        velocity_spread: 0.0,
        turbulence: 0.0,
        position: Vec3::new(0.0, 1.0, 0.0),
        lifetime: 5.0,
        lifetime_spread: 0.0,
        fade_in: 0.0,
        fade_out: 0.0,
        rate: 1000.0,
        ..Emitter::default()
    };
    let mut tops = [0.0_f32; 4];
    for particle in at(&emitter, 20.0) {
        assert!(particle.position.y > -1.0e-3, "{particle:?}");
        let seconds = particle.age * 5.0;
        // A fall of 1 m takes 0.45 s; each further arc has half the speed of the one before.
        let bounces = [0.452, 0.904, 1.13, 1.243].iter().filter(|time| seconds > **time).count();
        if let Some(top) = tops.get_mut(bounces) {
            *top = top.max(particle.position.y);
        } else {
            assert_eq!(particle.velocity, Vec3::ZERO, "{seconds}");
        }
    }
    for (top, expected) in tops.iter().zip([1.0, 0.25, 0.0625, 0.0156]) {
        assert!((top - expected).abs() < 0.01 * expected + 1.0e-3, "{tops:?}");
    }
}

#[test]
fn box_of_an_emission_contains_its_particles() {
    let mut stretched = Settings::default();
    stretched.sprite.stretch = 0.2;
    stretched.sprite.stretch_limit = 20.0;
    for extent in [Settings::default(), stretched].map(|settings| SpriteExtent::from_settings(&settings)) {
        for emitter in emitters() {
            for time in [0.0, 0.05, 1.0, 3.0, 50.0] {
                let measured = particle_bounds(&at(&emitter, time), extent);
                let promised = emitter.snapshot(time).bounds(extent);
                if at(&emitter, time).is_empty() {
                    continue;
                }
                let holds = promised.min.cmple(measured.min).all() && promised.max.cmpge(measured.max).all();
                assert!(holds, "{emitter:?} at {time}: {measured:?} in {promised:?}");
            }
        }
    }
}

#[test]
fn sample_represents_all_particles_and_stays_the_same() {
    let emitter = Emitter { rate: 20_000.0, lifetime: 5.0, lifetime_spread: 0.0, ..Emitter::default() };
    let few = |time| {
        let mut particles = Vec::new();
        emitter.snapshot(time).sample(&mut particles);
        particles
    };
    let all = at(&emitter, 9.0);
    let now = few(9.0);
    let soon = few(9.0004);
    assert!((900..=1100).contains(&now.len()), "{}", now.len());
    let mean = |particles: &[Particle]| particles.iter().map(|p| p.position).sum::<Vec3>() / particles.len() as f32;
    assert!((mean(&all) - mean(&now)).length() < 0.1);
    let mut without_step = emitter.snapshot(9.0);
    without_step.step = 0;
    without_step.first_sample = 0;
    let mut particles = Vec::new();
    without_step.sample(&mut particles);
    assert_eq!(particles.len(), all.len());
    // Except for a birth or a death.
    let same = |a: &&Particle| soon.iter().any(|b| a.position.distance(b.position) < 0.002);
    assert!(now.iter().filter(same).count() >= now.len() - 2);
}

#[test]
fn too_many_particles_are_refused() {
    let emitter = Emitter { rate: 100_000.0, lifetime: 600.0, ..Emitter::default() };
    let error = emitter.validate(|| "systems[0].emitter".into()).unwrap_err();
    let expected = "at this rate, 72000000 particles are alive at once; expected at most 1048576";
    assert_eq!(error.to_string(), format!("systems[0].emitter.rate: {expected}"));
    Emitter { duration: 0.1, ..emitter }.validate(String::new).unwrap();
}

#[test]
fn paths_give_the_particles_of_any_time_in_any_order() {
    let emitter = Emitter { turbulence: 1.0, duration: 3.0, period: 4.0, rate: 200.0, ..Emitter::default() };
    let other = Emitter { wind: Vec3::X, ..emitter };
    let mut paths = EmitterPaths::default();
    let mut sample_paths = EmitterPaths::default();
    let frames = (0..90).map(|frame| (emitter, 20.0 + f64::from(frame) / 30.0));
    let seeks = [(emitter, 3.0), (emitter, 21.0), (other, 21.0), (emitter, 20.9), (emitter, 400.0), (emitter, 399.9)];
    for (emitter, time) in frames.chain(seeks) {
        let snapshot = emitter.snapshot(time);
        let mut expected = Vec::new();
        let mut particles = Vec::new();
        let check = |particles: &[Particle], expected: &[Particle]| {
            assert_eq!(particles.len(), expected.len(), "{time}");
            for (particle, expected) in particles.iter().zip(expected) {
                // Of the rounding of other frames, amplified by the swirls.
                let error = particle.position.distance(expected.position);
                assert!(error < 2.0e-3, "{time}: {error} at {}", expected.age);
            }
        };
        snapshot.evaluate(&mut expected);
        snapshot.evaluate_along(&mut paths, &mut particles);
        check(&particles, &expected);
        snapshot.sample(&mut expected);
        snapshot.sample_along(&mut sample_paths, &mut particles);
        check(&particles, &expected);
    }
}
