//! The effects of commands.

use super::camera::CameraControl;
use super::controller::RenderController;
use super::slot::RenderSlot;
use crate::command::Command;
use crate::status::{LaneId, State};
use crate::view::method_of;
use bidir::driver::Settings;
use bidir::film::Layers;
use bidir::settings::Request;
use formats::film::{Developed, metadata};

impl RenderController {
    /// Executes a command. If it is refused, the status gets the reason.
    pub(super) fn execute(&mut self, command: Command) {
        match self.apply(command) {
            Ok(message) => self.message = message,
            Err(refusal) => {
                self.log(&format!("refused: {refusal}"));
                self.message = Some(refusal);
            }
        }
    }

    /// Applies a command. Returns a message about it, if there is one.
    fn apply(&mut self, command: Command) -> Result<Option<String>, String> {
        match command {
            Command::Pause {} => self.pause()?,
            Command::Resume {} => self.resume()?,
            Command::Stop {} => self.stop(),
            Command::Restart {} => self.is_stale = true,
            Command::Method {
                lane,
                integrator,
                shadow_rays,
            } => self.set_method(lane, &integrator, &shadow_rays)?,
            Command::Split {
                on,
                integrator,
                shadow_rays,
            } => self.split(on, integrator.as_deref(), shadow_rays.as_deref())?,
            Command::Strategies { lane, vertices } => self.set_strategies(lane, vertices)?,
            Command::Orbit { yaw, pitch } => self.moved(|view| view.orbit(yaw, pitch))?,
            Command::Dolly { factor } => self.moved(|view| view.dolly(factor))?,
            Command::Pan { right, up } => self.moved(|view| view.pan(right, up))?,
            Command::Walk(walk) => self.moved(|view| view.walk(walk))?,
            Command::Home {} => {
                self.camera.go_home();
                self.is_stale = true;
            }
            Command::Save { name, lane } => return self.save(&name, lane).map(Some),
        }
        Ok(None)
    }

    fn pause(&mut self) -> Result<(), String> {
        self.catch_up();
        self.check_runs()?;
        self.state = State::Paused;
        self.log("paused");
        Ok(())
    }

    fn resume(&mut self) -> Result<(), String> {
        self.check_runs()?;
        self.state = State::Rendering;
        self.log("goes on");
        Ok(())
    }

    /// Refuses commands that have no meaning after the render has ended.
    fn check_runs(&self) -> Result<(), String> {
        match self.state {
            State::Rendering | State::Paused => Ok(()),
            // Lanes that begin anew will render.
            _ if self.is_stale => Ok(()),
            _ => Err("the render has ended: `restart` starts over".to_owned()),
        }
    }

    /// Begins stale lanes anew, so that they can render.
    fn catch_up(&mut self) {
        if self.is_stale {
            self.begin();
        }
    }

    fn stop(&mut self) {
        self.catch_up();
        self.state = State::Done;
        self.log("stopped");
    }

    fn set_method(&mut self, lane: LaneId, integrator: &str, rays: &str) -> Result<(), String> {
        let settings = self.method(self.wanted(lane)?, integrator, rays)?;
        self.wanted[lane.index()] = settings;
        self.is_stale = true;
        Ok(())
    }

    fn split(
        &mut self,
        on: bool,
        integrator: Option<&str>,
        rays: Option<&str>,
    ) -> Result<(), String> {
        if !on {
            self.wanted.truncate(1);
            self.slots.truncate(1);
            self.queue.state().show(LaneId::B, None);
            return Ok(());
        }
        let first = self.wanted(LaneId::A)?;
        let [own_integrator, own_rays] = method_of(first);
        let integrator = integrator.unwrap_or(&own_integrator);
        let rays = rays.unwrap_or(&own_rays);
        let second = self.method(first, integrator, rays)?;
        self.wanted.truncate(1);
        self.wanted.push(second);
        self.is_stale = true;
        Ok(())
    }

    fn set_strategies(&mut self, lane: LaneId, vertices: usize) -> Result<(), String> {
        let most = Layers::MOST_STRATEGY_VERTICES;
        if vertices > most || vertices == 1 {
            return Err(format!(
                "images of strategies need paths of 2 to {most} vertices, or 0 for none"
            ));
        }
        let old = &self.wanted(lane)?.layers;
        let layers = Layers::new(old.aovs(), old.light_groups(), vertices).with_raw();
        self.wanted[lane.index()].layers = layers;
        self.is_stale = true;
        Ok(())
    }

    fn moved(
        &mut self,
        go: impl FnOnce(&mut CameraControl) -> Result<(), String>,
    ) -> Result<(), String> {
        go(&mut self.camera)?;
        self.is_stale = true;
        Ok(())
    }

    fn save(&mut self, name: &str, lane: LaneId) -> Result<String, String> {
        let has_pass = |slot: &&RenderSlot| !slot.render.session.film().passes().is_empty();
        let found = self.slots.get(lane.index()).filter(has_pass);
        let slot = found.ok_or("nothing is saved: no pass is done yet")?;
        let film = slot.render.session.film();
        self.saved.save(name, |path| {
            let metadata = metadata(&slot.render.header());
            let written = Developed::new(film).write_exr(path, film.settings(), &metadata);
            written.map_err(|error| error.to_string())
        })?;
        let message = format!("wrote {name} with {} spp", film.passes().len());
        self.log(&message);
        Ok(message)
    }

    /// Returns the requested settings of a lane.
    fn wanted(&self, lane: LaneId) -> Result<&Settings, String> {
        let wanted = self.wanted.get(lane.index());
        wanted.ok_or_else(|| "there is no second lane: `split` makes one".to_owned())
    }

    /// Returns `settings` with another method. Russian roulette is the requested one, or else the method's default.
    fn method(
        &self,
        settings: &Settings,
        integrator: &str,
        rays: &str,
    ) -> Result<Settings, String> {
        let mut request = Request {
            path_roulette: self.asked.roulette,
            ..Request::default()
        };
        for (name, value) in [("integrator", integrator), ("shadow-rays", rays)] {
            let set = request.set(name, value);
            set.map_err(|error| error.to_string())?;
        }
        Ok(request.apply(settings))
    }
}
