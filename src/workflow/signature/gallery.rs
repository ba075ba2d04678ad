//! The images of all effects that a robot knows.

use tautline_core::effect::{Effect, every_effect};
use tautline_core::estimation::Control;
use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_core::simulation::SimulationError;

use super::image::Image;
use super::stage::Stage;

/// The image of one effect at typical size.
#[derive(Debug, Clone)]
pub struct Signature {
    /// The effect.
    pub effect: &'static Effect,
    /// Its size in words.
    pub size: String,
    /// Sentence on the effect.
    pub cause: String,
    /// Advice for the workshop.
    pub workshop: String,
    /// The residuals in which it shows, the clearest first; or one sentence on why it does not.
    pub images: Result<Vec<Image>, String>,
}

/// The images of all effects of the catalogue and of all hypotheses that a robot knows.
#[derive(Debug, Clone)]
pub struct Gallery {
    /// The robot.
    pub robot: Robot,
    /// Number of poses.
    pub poses: usize,
    /// The images, in the order of the catalogue.
    pub signatures: Vec<Signature>,
}

/// Effects whose images a robot has, in their order: those of the user first.
pub(super) fn effects(robot: &Robot) -> impl Iterator<Item = &'static Effect> + use<'_> {
    robot.hypothesis_effects().chain(every_effect())
}

impl Gallery {
    /// Simulates every effect on a robot, at the given poses if it can hold them. `observe` gets the number of effects that are
    /// done and of all, and may stop: then there is no gallery.
    ///
    /// # Errors
    /// If the robot can be held nowhere.
    pub fn new(
        robot: &Robot,
        poses: &[Pose],
        observe: &mut dyn FnMut(usize, usize) -> Control,
    ) -> Result<Option<Self>, SimulationError> {
        let stage = Stage::new(robot, poses)?;
        let all: Vec<&'static Effect> = effects(robot).collect();
        let mut signatures = Vec::with_capacity(all.len());
        for effect in &all {
            if observe(signatures.len(), all.len()) == Control::Cancel {
                return Ok(None);
            }
            signatures.push(stage.signature(effect));
        }
        Ok(Some(Self {
            robot: robot.clone(),
            poses: stage.poses(),
            signatures,
        }))
    }
}

impl Signature {
    /// Image of one effect by itself, as in [`Gallery::new`].
    ///
    /// # Errors
    /// If the robot can be held nowhere.
    pub fn of(
        robot: &Robot,
        poses: &[Pose],
        effect: &'static Effect,
    ) -> Result<Self, SimulationError> {
        Ok(Stage::new(robot, poses)?.signature(effect))
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;

    fn gallery(name: &str) -> Gallery {
        let robot = presets::find(name).expect("a preset").robot;
        let gallery = Gallery::new(&robot, &[], &mut |_, _| Control::Continue);
        gallery.expect("a robot").expect("not stopped")
    }

    fn seen<'g>(gallery: &'g Gallery, id: &str) -> Result<Vec<&'g str>, &'g str> {
        let mut all = gallery.signatures.iter();
        let one = all.find(|one| one.effect.id() == id).expect(id);
        let images = one.images.as_ref();
        let names = images.map(|images| images.iter().map(|image| image.name.as_str()).collect());
        names.map_err(String::as_str)
    }

    #[test]
    fn every_effect_has_one_image_or_a_reason_for_none() {
        let gallery = gallery("mini");
        assert_eq!(gallery.signatures.len(), every_effect().count());
        for one in &gallery.signatures {
            assert!(!one.cause.is_empty() && !one.workshop.is_empty(), "{one:?}");
            match &one.images {
                Ok(images) => assert!((1..=3).contains(&images.len())),
                Err(why) => assert!(why.ends_with('.'), "{why}"),
            }
        }
        // A hidden change of one winch is in the lengths of its cable; the laser's own error in the laser.
        assert_eq!(
            seen(&gallery, "winch_scale").expect("seen")[0],
            "Length readings"
        );
        assert_eq!(
            seen(&gallery, "laser_scale").expect("seen")[0],
            "Laser's readings"
        );
        assert_eq!(
            seen(&gallery, "force_bias").expect("seen")[0],
            "Tension readings"
        );
        // MINI has no external instrument.
        assert_eq!(
            seen(&gallery, "tracker_frame"),
            Err("No reading of this robot depends on it.")
        );
        let drawn = gallery.signatures.iter().filter(|one| one.images.is_ok());
        assert!(drawn.count() >= 30);
    }

    #[test]
    fn a_gallery_can_be_stopped() {
        let robot = presets::find("mini").expect("a preset").robot;
        let stop = |done, _| {
            if done < 3 {
                Control::Continue
            } else {
                Control::Cancel
            }
        };
        let stopped = Gallery::new(&robot, &[], &mut { stop });
        assert!(stopped.expect("a robot").is_none());
    }
}
