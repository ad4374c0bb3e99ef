//! Commands of clients, as JSON.

use crate::status::LaneId;
use serde::Deserialize;

/// A command to a render.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "command", rename_all = "lowercase", deny_unknown_fields)]
pub enum Command {
    /// Render no further pass until [`Self::Resume`].
    Pause {},
    /// Continue after [`Self::Pause`].
    Resume {},
    /// End the render.
    Stop {},
    /// Begin all lanes anew.
    Restart {},
    /// Begin a lane anew with another estimator.
    Method {
        /// The lane.
        lane: LaneId,
        /// The estimator, by its name on the command line.
        integrator: String,
        /// The selection of shadow rays, by its name on the command line.
        #[serde(rename = "shadowRays")]
        shadow_rays: String,
    },
    /// Begin all lanes anew, with a second lane beside the first or without one.
    Split {
        /// True for two lanes.
        on: bool,
        /// The estimator of the second lane. None: the same as of the first.
        integrator: Option<String>,
        /// The selection of shadow rays of the second lane. None: the same as of the first.
        #[serde(rename = "shadowRays")]
        shadow_rays: Option<String>,
    },
    /// Begin a lane anew with images of strategies.
    Strategies {
        /// The lane.
        lane: LaneId,
        /// Maximum number of vertices of paths whose strategies have images; 0: no images.
        vertices: usize,
    },
    /// Move the camera around its target. Unit: radians.
    Orbit {
        /// The angle to the camera's right.
        yaw: f32,
        /// The angle upwards.
        pitch: f32,
    },
    /// Move the camera away from its target.
    Dolly {
        /// The factor of the distance.
        factor: f32,
    },
    /// Move the camera across its target. Unit: the distance.
    Pan {
        /// The step to the camera's right.
        right: f32,
        /// The step upwards.
        up: f32,
    },
    /// Move the camera, and turn it at its new position.
    Walk(Walk),
    /// Move the camera back to its position in the scene.
    Home {},
    /// Write an EXR into the folder that the server was started in.
    Save {
        /// The name of the file, which has no folders and ends in `.exr`.
        name: String,
        /// The lane.
        #[serde(default)]
        lane: LaneId,
    },
}

/// A step and a turn of the camera. Unit: the distance to the target; for angles, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Walk {
    /// The step along the axis.
    pub forward: f32,
    /// The step to the picture's right.
    pub right: f32,
    /// The step upwards in the picture.
    pub up: f32,
    /// The turn to the right.
    pub yaw: f32,
    /// The turn up.
    pub pitch: f32,
}

impl Command {
    /// Returns true if the command only moves the camera. Such commands often come in sequence.
    pub fn is_move(&self) -> bool {
        matches!(
            self,
            Self::Orbit { .. } | Self::Dolly { .. } | Self::Pan { .. } | Self::Walk(_)
        )
    }

    /// Returns true if the command makes the running pass useless.
    pub fn ends_pass(&self) -> bool {
        !matches!(self, Self::Resume {} | Self::Save { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(json: &str, command: &Command) {
        assert_eq!(&serde_json::from_str::<Command>(json).unwrap(), command);
    }

    #[test]
    fn commands_are_read_as_they_are_documented() {
        check(r#"{"command":"pause"}"#, &Command::Pause {});
        check(
            r#"{"command":"method","lane":"b","integrator":"bdpt","shadowRays":"per-pair"}"#,
            &Command::Method {
                lane: LaneId::B,
                integrator: "bdpt".into(),
                shadow_rays: "per-pair".into(),
            },
        );
        check(
            r#"{"command":"split","on":false}"#,
            &Command::Split {
                on: false,
                integrator: None,
                shadow_rays: None,
            },
        );
        let walk = Walk {
            forward: 0.5,
            ..Walk::default()
        };
        check(r#"{"command":"walk","forward":0.5}"#, &Command::Walk(walk));
        let save = Command::Save {
            name: "a.exr".into(),
            lane: LaneId::A,
        };
        check(r#"{"command":"save","name":"a.exr"}"#, &save);
    }

    #[test]
    fn what_is_no_command_is_refused() {
        for json in [
            r#"{"command":"explode"}"#,
            r#"{"command":"pause","now":true}"#,
            r#"{"command":"orbit","yaw":1}"#,
            r#"{"command":"orbit","yaw":"1","pitch":0}"#,
            r#"{"command":"walk","sideways":1}"#,
            r#"{"command":"strategies","lane":"c","vertices":6}"#,
            r#"{"command":"strategies","lane":"a","vertices":-1}"#,
            "pause",
        ] {
            assert!(serde_json::from_str::<Command>(json).is_err(), "{json}");
        }
    }
}
