//! `tandem replay`: logs through a controller again.

mod destination;
mod first;
mod ladder;
mod options;
mod result;

use std::cell::Cell;
use std::collections::BTreeSet;
use std::fs;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use ::compare::{CATALOGUE, Meter, unit_of_law};
use anyhow::{Context as _, Result, bail, ensure};
use clap::Args;
use controller::Law;
pub use destination::replay_header;
use first::first_cause;
use ladder::Ladder;
use options::seconds;
pub use options::{How, HumanName, ModeName, PlantName, patience};
use replay::{Gains, Mode, Outcome, PlantClaim, Reaction, Recording, Window};
use result::{Crossings, Doubt, Plant, Run};
use schemas::log::Stop;
use schemas::{Event, Explored, Header, Scenario, Span, Stamped, World};
use serde::Serialize;

use crate::arm::DrivenPlant;
use crate::cli::Common;
use crate::controller_choice::ControllerChoice;
use crate::faults::FaultArgs;
use crate::fleet::watch;
use crate::interrupt::Interrupted;
use crate::status::Status;
use crate::{arm, command, interrupt, logs, output, side_by_side};

/// Replay logs into a controller.
///
/// Open loop feeds the recorded sensors and joystick at the recorded step times and compares what
/// the controller says. Closed loop lets the recorded person drive a simulated robot in the log's
/// own world, with sensors simulated anew from the recorded seed.
///
/// With the controller that recorded the log, both give the recording back bit for bit.
#[derive(Args, Clone)]
#[command(after_help = "\
Examples:
  tandem replay session.mcap
  tandem replay session.mcap --mode closed
  tandem replay logs/*.mcap --controller paper-kinematic --mode closed -o replayed/
  tandem replay logs/*.mcap --controller paper-kinematic --mode closed --human ladder
  tandem replay session.mcap --mode closed --human fitted --plant identified --floor
  tandem replay session.mcap --mode closed --controller paper-kinematic -o both.mcap
  tandem replay session.mcap --mode closed --from 12 --to 20
  tandem replay session.mcap --mode closed --world map
  tandem replay session.mcap --mode closed --fault sonar-dead=3 --fault latency=0.1

Exit status: 1 when an open-loop replay of the recording controller is not identical to the
recording, or when a damaged log could be replayed in part only.")]
pub struct Replay {
    /// The logs to replay
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Controller to replay into [default: the one that recorded the log]
    #[arg(long, default_value = "recorded", value_name = "C", hide_default_value = true)]
    pub controller: ControllerChoice,
    #[command(flatten)]
    pub how: How,
    /// Where to begin, seconds from the start; what comes before is run through to warm up
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Where to end, seconds from the start
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true)]
    pub to: Option<f64>,
    /// The plant of a closed loop: the one that the log claims, or the one that it shows
    #[arg(long, value_enum, default_value_t = PlantName::Recorded)]
    pub plant: PlantName,
    /// Closed loop in another world than the log's: that of a scenario file, or `map` for the one that
    /// the log's own sonars heard (see `tandem map`)
    #[arg(long, value_name = "SCENARIO.toml|map")]
    pub world: Option<PathBuf>,
    /// Closed loop: also measure how far the recording controller's own replay is from the recording
    #[arg(long)]
    pub floor: bool,
    #[command(flatten)]
    pub faults: FaultArgs,
    /// Write recording and replay side by side, as /A/* and /B/*, with a layout for viewers: a file for
    /// one log, a folder for several
    #[arg(long, short, value_name = "FILE|DIR")]
    pub output: Option<PathBuf>,
}

#[derive(Serialize)]
struct Replayed {
    runs: Vec<Run>,
    /// With `--human ladder`: the levels of each log side by side, widest spread first.
    #[serde(skip_serializing_if = "Option::is_none")]
    ladder: Option<Vec<Ladder>>,
    /// With a fitted person: the gains, pooled over the logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    gains: Option<PooledGains>,
}

#[derive(Serialize)]
struct PooledGains {
    k_theta: f64,
    delay_s: f64,
}

impl Replay {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let How { mode, human, .. } = self.how;
        let gains =
            if mode.needs_gains(human) { arm::gains(common, &self.logs) } else { Gains::PRIOR };
        let modes: Vec<Mode> = match mode {
            ModeName::Open => vec![Mode::Open],
            ModeName::Closed => human.levels(gains).into_iter().map(Mode::Closed).collect(),
        };
        let several = self.logs.len() > 1 || modes.len() > 1;
        if several && self.output.as_ref().is_some_and(|output| output.is_file()) {
            bail!("-o names a file, but there are several replays: name a folder");
        }
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from >= to
        {
            bail!("--from {from} does not come before --to {to}");
        }
        mode.refuse_without_effect(human, self.plant)?;
        if mode == ModeName::Open && self.world.is_some() {
            bail!("in open loop the recorded sensors are heard: --world goes with --mode closed");
        }
        if mode == ModeName::Open && self.floor {
            bail!("in open loop the robot moves as recorded: --floor goes with --mode closed");
        }
        self.faults.faults()?;
        self.guard_outputs(common, several)?;
        let (this, of_all, all_modes) = (self.clone(), common.clone(), modes.clone());
        let work = move |log: &PathBuf| this.replay_log(&of_all, log, &all_modes, several);
        let limit = self.how.hang_after;
        let results = watch::each(common, self.logs.clone(), "replaying", limit, work);
        let (mut runs, mut ladders) = (Vec::new(), Vec::new());
        for (log, result) in self.logs.iter().zip(results) {
            match result {
                Ok((of_log, reaction)) => {
                    if human == HumanName::Ladder
                        && let Some(reaction) = reaction
                    {
                        ladders.extend(Ladder::of(&of_log, reaction));
                    }
                    runs.extend(of_log);
                }
                Err(error) => {
                    let controller = self.controller.label();
                    runs.extend(
                        modes.iter().map(|mode| Run::failed(log, *mode, controller, &error)),
                    );
                }
            }
        }
        if let Some(output) = &self.output
            && runs.iter().any(|run| run.output.is_some())
        {
            side_by_side::write_layout(&side_by_side::layout_beside(output, several))?;
        }
        Ladder::rank(&mut ladders);
        let status = runs.iter().fold(Status::Done, |worst, run| worst.worse(run.status));
        self.tell(&runs);
        let ladder = (human == HumanName::Ladder && mode == ModeName::Closed).then_some(ladders);
        let Gains { k_theta, delay_s } = gains;
        let gains = mode.needs_gains(human).then_some(PooledGains { k_theta, delay_s });
        output::print(common, &Replayed { runs, ladder, gains }, |result| {
            let runs: String = result.runs.iter().map(Run::text).collect();
            runs + &Ladder::text(result.ladder.as_deref().unwrap_or_default())
        })?;
        Ok(status)
    }

    /// What went wrong, and what is to be known about the runs, on standard error; the same of several levels
    /// once. What Ctrl-C kept from being replayed is one sentence with the number of logs.
    fn tell(&self, runs: &[Run]) {
        let mut told = BTreeSet::new();
        let mut tell = |text: String| {
            if told.insert(text.clone()) {
                output::note(&text);
            }
        };
        for run in runs {
            for warning in run.warnings(self.to) {
                tell(format!("warning: {}: {warning}", run.log));
            }
        }
        for run in runs.iter().filter(|run| !run.interrupted) {
            if let Some(error) = &run.error {
                tell(format!("error: {}", output::one_line(error)));
            }
        }
        let interrupted = |replayed: bool| {
            let runs = runs.iter().filter(|run| run.interrupted && run.is_replayed() == replayed);
            runs.map(|run| run.log.as_str()).collect::<BTreeSet<_>>()
        };
        let (part, none) = (interrupted(true), interrupted(false));
        let (part, none) = (part.len(), none.difference(&part).count());
        if part + none > 0 {
            let (count, all) = (part + none, self.logs.len());
            let in_part =
                if part > 0 { format!(", {part} of them in part") } else { String::new() };
            tell(format!(
                "error: interrupted; {count} of {all} logs not replayed to the end{in_part}"
            ));
        }
    }

    /// One log in every mode that was asked for, with what its person is like.
    fn replay_log(
        &self,
        common: &Common,
        log: &Path,
        modes: &[Mode],
        several: bool,
    ) -> Result<(Vec<Run>, Option<Reaction>)> {
        let name = || log.display().to_string();
        let header = logs::open(log)?.header().clone();
        let spec = self.controller.for_log(&header)?;
        output::detail(common, || {
            let run = &header.run;
            format!(
                "{}: {} recorded with {}, seed {}; replaying into {}",
                log.display(),
                run.scenario,
                run.controller,
                run.seed,
                spec.name
            )
        });
        let closed = modes.iter().any(|mode| matches!(mode, Mode::Closed(_)));
        let mut plant = None;
        let recording = if closed {
            let recording =
                Recording::read(logs::open_raw(log).with_context(name)?).with_context(name)?;
            let (mut recording, driven) =
                arm::driven(log, recording, self.plant).with_context(name)?;
            plant = Some(driven);
            if let Some((world, explored)) = self.world(log)? {
                recording = recording.in_world(world, explored);
            } else if header.scenario.world.is_empty() {
                output::say(
                    common,
                    &format!(
                        "{}: the log has no world, so nothing will be met; --world map builds one",
                        log.display()
                    ),
                );
            }
            Some(Arc::new(recording))
        } else {
            None
        };
        // What is measured and written is of the world that is driven in.
        let replayed = recording
            .as_ref()
            .map_or_else(|| header.clone(), |recording| recording.header().clone());
        let reaction = recording.as_ref().map(|recording| Reaction::of(recording));
        let window = self.window();
        let mut runs = Vec::new();
        for mode in modes {
            if interrupt::pressed() && !runs.is_empty() {
                let error = Interrupted::NotBegun.into();
                runs.push(Run::failed(log, *mode, self.controller.label(), &error));
                continue;
            }
            let began = Instant::now();
            let open = || logs::open_raw(log).with_context(name);
            arm::made(&replayed, &spec).with_context(name)?;
            let replay = match (mode, &recording) {
                (Mode::Closed(person), Some(recording)) => {
                    replay::Replay::beside(open()?, recording, &spec, *person)
                }
                _ => replay::Replay::new(|| logs::open_raw(log), &spec, *mode),
            };
            let faults = self.faults.faults()?;
            let replay = replay.with_context(name)?.within(window, open()?).under(faults);
            let run = self.replay_one(
                common,
                log,
                (*mode, several, &spec, began),
                replay,
                [&header, &replayed],
            );
            let mut run = match run {
                Err(error) if Interrupted::caused(&error) && !runs.is_empty() => {
                    runs.push(Run::failed(log, *mode, self.controller.label(), &error));
                    continue;
                }
                run => run?,
            };
            run.from_s = window.from_s;
            run.period_s = Span(header.run.control_period_ns).seconds();
            if run.horizon.as_ref().is_some_and(Crossings::never) {
                // As a crossing is, the end is told from the start of the log.
                run.horizon_s = Some(run.from_s + run.duration_s);
            }
            match &plant {
                Some(DrivenPlant::Identified(found)) => run.plant = Some(Plant::of(found)),
                Some(DrivenPlant::Claimed(PlantClaim::Contradicted(doubt))) => {
                    run.plant_doubt = Some(Doubt::of(doubt));
                }
                _ => {}
            }
            if self.floor
                && let (Mode::Closed(person), Some(recording)) = (mode, &recording)
            {
                run.floor = Some(arm::floor(log, recording, *person).with_context(name)?);
            }
            runs.push(run);
        }
        Ok((runs, reaction))
    }

    /// The world that was asked for, where another than the log's was.
    fn world(&self, log: &Path) -> Result<Option<(World, Option<Explored>)>> {
        let Some(world) = &self.world else { return Ok(None) };
        if world.as_os_str() == "map" {
            let (map, _) = command::map::of_log(log)?;
            return Ok(Some((map.world().clone(), Some(map.explored().clone()))));
        }
        let name = || world.display().to_string();
        let text = fs::read_to_string(world).with_context(name)?;
        let scenario = Scenario::from_toml(&text).with_context(name)?;
        Ok(Some((scenario.world, scenario.explored)))
    }

    fn window(&self) -> Window {
        Window { from_s: self.from.unwrap_or(0.0), to_s: self.to.unwrap_or(f64::INFINITY) }
    }

    fn replay_one(
        &self,
        common: &Common,
        log: &Path,
        (mode, several, spec, began): (Mode, bool, &controller::Spec, Instant),
        mut replay: replay::Replay<BufReader<File>>,
        [recorded_header, header]: [&Header; 2],
    ) -> Result<Run> {
        let output = match &self.output {
            None => None,
            Some(output) => {
                let path = self.output_for(log, &spec.name, mode, output, several);
                logs::guard_input(&path, log)?;
                logs::guard(&path, common.force)?;
                Some((path, replay_header(header, spec, mode, logs::hash_file(log)?)))
            }
        };
        // Metrics over the whole run, and as far as the recorded person is to be believed: until then they
        // are the same.
        let closed = matches!(mode, Mode::Closed(_));
        let mut whole = closed.then(|| Meter::new(header));
        let mut until_horizon = None;
        let (interrupted, cut_short) = (Cell::new(false), Cell::new(false));
        let mut next = || -> Result<Option<Stamped<Event>>> {
            interrupted.set(interrupt::pressed());
            if interrupted.get() {
                return Ok(None);
            }
            let event = arm::caught(|| replay.next_event())?;
            cut_short.set(event.is_none() && replay.is_cut_short());
            if let (Some(whole), Some(event)) = (&mut whole, &event) {
                let parted = replay.horizon().is_some_and(|horizon| horizon.first_s().is_some());
                if parted && until_horizon.is_none() {
                    until_horizon = Some(whole.clone());
                }
                whole.observe(event);
            }
            Ok(event)
        };
        let written = match output {
            None => {
                while next()?.is_some() {}
                None
            }
            Some((path, replayed)) => {
                let mut recorded = logs::open(log)?;
                let part = self.window();
                // Damage ends the recording; the replay meets it too, and reports it.
                let recorded = || {
                    let inside = |event: &Stamped<Event>| part.contains(header.run.start, event.at);
                    let events = std::iter::from_fn(|| recorded.next_event().ok().flatten());
                    Ok(events.take_while(|_| !interrupted.get()).find(inside))
                };
                let headers = [recorded_header, &replayed];
                let stopped = || match (interrupted.get(), cut_short.get()) {
                    (true, _) => Some(Stop::Told),
                    (false, cut_short) => cut_short.then_some(Stop::Source),
                };
                side_by_side::write(&path, headers, recorded, &mut next, stopped)?;
                Some(path)
            }
        };
        let interrupted = interrupted.get();
        let outcome = match replay.finish().with_context(|| log.display().to_string()) {
            Ok(outcome) => outcome,
            Err(error) => {
                // A log without a step is no result.
                if let Some(path) = &written {
                    let _ = fs::remove_file(path);
                }
                ensure!(!interrupted, Interrupted::UnderWay);
                return Err(error);
            }
        };
        let error = match &outcome.damage {
            _ if interrupted => Some(format!("{}: {}", log.display(), Interrupted::UnderWay)),
            Some(damage) => Some(format!("{}: {damage}", log.display())),
            None => None,
        };
        let elapsed_s = began.elapsed().as_secs_f64();
        let status = self.status(&outcome, mode, interrupted);
        let controller = match &self.controller {
            ControllerChoice::Recorded => spec.name.clone(),
            ControllerChoice::Version { typed, .. } => typed.clone(),
        };
        let [until_horizon, whole] = [until_horizon.or_else(|| whole.clone()), whole]
            .map(|meter| meter.and_then(|meter| meter.finish().ok()));
        let first = outcome.first_difference.as_deref();
        let mut first_cause = first.and_then(|first| first_cause(first, header.run.start));
        let mut run = Run::of(log, mode, &controller, outcome);
        let accelerates = |spec: &controller::Spec| spec.law == Law::Dynamic;
        let recorded = ControllerChoice::Recorded.for_log(recorded_header).ok();
        if recorded.is_some_and(|recorded| accelerates(&recorded) == accelerates(spec)) {
            // Which of two units is known.
            let unit = &mut run.max_deviation_unit;
            *unit = unit.map(|unit| unit_of_law(unit, accelerates(spec)));
            if let Some(cause) = &mut first_cause {
                cause.take_law(accelerates(spec));
            }
        }
        Ok(Run {
            first_cause,
            output: written.map(|path| path.display().to_string()),
            until_horizon: until_horizon.map(|measured| {
                CATALOGUE.iter().map(|m| (m.name, measured.metrics.get(m.name))).collect()
            }),
            interrupted,
            realtime_factor: (elapsed_s > 0.0).then(|| run.duration_s / elapsed_s),
            error,
            status,
            measured: whole,
            ..run
        })
    }

    fn status(&self, outcome: &Outcome, mode: Mode, interrupted: bool) -> Status {
        if interrupted {
            return Status::Impossible;
        }
        let recording_controller = self.controller == ControllerChoice::Recorded;
        let should_be_identical =
            mode == Mode::Open && recording_controller && self.faults.is_empty();
        if outcome.damage.is_some() || (should_be_identical && !outcome.identical_to_recorded) {
            Status::Differs
        } else {
            Status::Done
        }
    }
}
