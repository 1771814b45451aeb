//! Many environments that step together, on as many threads as allowed.
//!
//! Each environment does what it would do alone: results do not depend on the number of threads.

use crate::episode::{Clock, Episode, Facts, Outcome};
use crate::prefetch::prefetch;
use crate::reward::{PART_NAMES, Parts, TERM_NAMES, Terms};
use crate::setup::Source;
use crate::threads::{Stretch, Threads};
use hp_plant::command::ACTUATOR_PLACES;
use hp_plant::error::{PlantError, PlantResult};
use hp_trip::run::EndReason;
use std::sync::{Mutex, PoisonError};

/// Parts of a reward.
pub const PARTS: usize = PART_NAMES.len();

/// Terms that rewards are counted from.
pub const TERMS: usize = TERM_NAMES.len();

/// What happens to an environment whose trip has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Autoreset {
    /// The next step resets it and ignores its action.
    NextStep,
    /// It is reset within the step that ended it.
    SameStep,
    /// It must be reset by hand.
    Disabled,
}

/// Actions of all environments, row by row.
#[derive(Debug, Clone, Copy)]
pub enum Actions<'a> {
    /// Options.
    Levels(&'a [i64]),
    /// Normalised values.
    Values(&'a [f32]),
}

/// Where actions of all environments go, row by row.
#[derive(Debug)]
pub enum ActionsMut<'a> {
    /// Options.
    Levels(&'a mut [i64]),
    /// Normalised values.
    Values(&'a mut [f32]),
}

/// Where the results of a step go, one entry an environment.
#[derive(Debug)]
pub struct Results<'a> {
    /// Observations, row by row.
    pub observations: &'a mut [f32],
    /// Rewards.
    pub rewards: &'a mut [f64],
    /// Trips that ended.
    pub terminated: &'a mut [bool],
    /// Trips cut off by the limit of steps.
    pub truncated: &'a mut [bool],
    /// Parts of the rewards, one part after the other.
    pub parts: &'a mut [f64],
    /// What else is wanted.
    pub extras: Extras<'a>,
}

/// Results that are worked out where there is room for them, one entry an environment; empty where nobody wants them.
#[derive(Debug, Default)]
pub struct Extras<'a> {
    /// See [`Terms::cost`].
    pub costs: &'a mut [f64],
    /// Terms of the step, one after the other.
    pub terms: &'a mut [f64],
    /// Options that the plant would grant next, row by row.
    pub masks: &'a mut [bool],
}

/// A trip that is over.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// Environment.
    pub index: usize,
    /// Why it ended; cut off by the limit of steps where absent.
    pub end: Option<EndReason>,
    /// What it was.
    pub facts: Facts,
    /// Its terms.
    pub terms: Terms,
    /// Its totals by name.
    pub totals: Vec<(String, Option<f64>)>,
    /// Parts of the last reward.
    pub parts: Parts,
    /// Terms of the last step.
    pub last_terms: Terms,
    /// What was seen at its end, where the environment was reset at once.
    pub last_seen: Option<LastSeen>,
}

/// What was seen at the end of a trip.
#[derive(Debug, Clone, PartialEq)]
pub struct LastSeen {
    /// Observation.
    pub observation: Vec<f32>,
    /// Options that the plant would have granted; empty where nobody wants them.
    pub mask: Vec<bool>,
}

/// What else a step tells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Events {
    /// Trips that ended.
    pub finished: Vec<Finished>,
    /// Environments that were reset.
    pub reset: Vec<usize>,
}

/// Environments with their clocks.
#[derive(Debug)]
pub struct Vector {
    episodes: Vec<Episode>,
    elapsed: Vec<u64>,
    over: Vec<bool>,
    /// Whether a trip was begun: beside the environments, so that to ask all does not fetch them from memory.
    begun: Vec<bool>,
    autoreset: Autoreset,
    step_limit: Option<u64>,
    threads: Threads,
}

/// What the threads tell of a step, in any order.
#[derive(Default)]
struct Told {
    events: Events,
    errors: Vec<(usize, PlantError)>,
}

/// Consecutive environments with their entries of all results.
struct Batch<'a> {
    first: usize,
    episodes: &'a mut [Episode],
    elapsed: &'a mut [u64],
    over: &'a mut [bool],
    observations: &'a mut [f32],
    rewards: &'a mut [f64],
    terminated: &'a mut [bool],
    truncated: &'a mut [bool],
    parts: [&'a mut [f64]; PARTS],
    costs: &'a mut [f64],
    terms: [&'a mut [f64]; TERMS],
    masks: &'a mut [bool],
}

/// Consecutive environments with their entries of one array.
struct Pairs<'a, T> {
    episodes: &'a mut [Episode],
    entries: &'a mut [T],
    width: usize,
}

/// What one environment works on.
struct Job<'a> {
    index: usize,
    episode: &'a mut Episode,
    elapsed: &'a mut u64,
    over: &'a mut bool,
    observation: &'a mut [f32],
    reward: &'a mut f64,
    terminated: &'a mut bool,
    truncated: &'a mut bool,
    mask: &'a mut [bool],
    /// What the step gave; nothing where a trip began.
    outcome: Option<Outcome>,
    told: &'a Mutex<Told>,
    /// What will be worked on soon.
    ahead: Option<&'a Episode>,
}

/// So many environments ahead of the one that is worked on are brought into the cache.
const AHEAD: usize = 2;

/// Shares in which they are asked for, spread over the work on one.
const SHARES: usize = 3;

/// Cuts off the first entries of a slice.
fn cut<'a, T>(slice: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    slice.split_off_mut(..count.min(slice.len())).unwrap_or_default()
}

impl Stretch for Batch<'_> {
    fn count(&self) -> usize {
        self.episodes.len()
    }

    fn take(&mut self, count: usize) -> Self {
        let share = |length: usize| length.checked_div(self.episodes.len()).unwrap_or_default() * count;
        let (observations, masks) = (share(self.observations.len()), share(self.masks.len()));
        let first = self.first;
        self.first += count.min(self.episodes.len());
        Self {
            first,
            episodes: cut(&mut self.episodes, count),
            elapsed: cut(&mut self.elapsed, count),
            over: cut(&mut self.over, count),
            observations: cut(&mut self.observations, observations),
            rewards: cut(&mut self.rewards, count),
            terminated: cut(&mut self.terminated, count),
            truncated: cut(&mut self.truncated, count),
            parts: self.parts.each_mut().map(|part| cut(part, count)),
            costs: cut(&mut self.costs, count),
            terms: self.terms.each_mut().map(|term| cut(term, count)),
            masks: cut(&mut self.masks, masks),
        }
    }
}

impl<T: Send> Stretch for Pairs<'_, T> {
    fn count(&self) -> usize {
        self.episodes.len()
    }

    fn take(&mut self, count: usize) -> Self {
        Self {
            episodes: cut(&mut self.episodes, count),
            entries: cut(&mut self.entries, count * self.width),
            width: self.width,
        }
    }
}

impl Vector {
    /// Environments before their first reset.
    #[must_use]
    pub fn new(
        episodes: Vec<Episode>,
        autoreset: Autoreset,
        step_limit: Option<u64>,
        threads: usize,
    ) -> Self {
        let count = episodes.len();
        Self {
            begun: episodes.iter().map(Episode::begun).collect(),
            episodes,
            elapsed: vec![0; count],
            over: vec![false; count],
            autoreset,
            step_limit,
            // More than one an environment would have nothing to do.
            threads: Threads::new(threads.min(count)),
        }
    }

    /// The environments.
    #[must_use]
    pub fn episodes(&self) -> &[Episode] {
        &self.episodes
    }

    /// The environments; to be reset and restored by the functions below, which note what has begun.
    pub fn episodes_mut(&mut self) -> &mut [Episode] {
        &mut self.episodes
    }

    /// Number of threads.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads.count()
    }

    /// Environments whose trip is over and that wait for their reset.
    #[must_use]
    pub fn over(&self) -> &[bool] {
        &self.over
    }

    /// Whether every environment has begun a trip.
    #[must_use]
    pub fn all_begun(&self) -> bool {
        !self.begun.contains(&false)
    }

    /// Resets one environment.
    ///
    /// # Errors
    /// See [`Episode::reset`].
    pub fn reset(&mut self, index: usize, seed: Option<u64>, once: Option<&Source>) -> PlantResult<()> {
        self.episodes[index].restart(seed, once)?;
        self.elapsed[index] = 0;
        self.over[index] = false;
        self.begun[index] = true;
        Ok(())
    }

    /// Lets every environment go on from where another one (or the same) is now.
    ///
    /// # Panics
    /// `from` has another length or names an environment that is not there.
    pub fn fork(&mut self, from: &[usize]) {
        assert_eq!(from.len(), self.episodes.len(), "one index for each environment");
        self.episodes = from.iter().map(|&index| self.episodes[index].clone()).collect();
        self.elapsed = from.iter().map(|&index| self.elapsed[index]).collect();
        self.over = from.iter().map(|&index| self.over[index]).collect();
        self.begun = from.iter().map(|&index| self.begun[index]).collect();
    }

    /// State of one environment with its clock.
    ///
    /// # Errors
    /// See [`Episode::to_bytes`].
    pub fn to_bytes(&self, index: usize) -> PlantResult<Vec<u8>> {
        let clock = Clock { elapsed: self.elapsed[index], over: self.over[index] };
        self.episodes[index].to_bytes(clock)
    }

    /// Restores environments, all or none.
    ///
    /// # Errors
    /// See [`Episode::read`].
    pub fn restore(&mut self, states: &[(usize, &[u8])]) -> PlantResult<()> {
        let read = states.iter().map(|&(index, bytes)| Ok((index, self.episodes[index].read(bytes)?)));
        for (index, restored) in read.collect::<PlantResult<Vec<_>>>()? {
            Clock { elapsed: self.elapsed[index], over: self.over[index] } = restored.clock;
            self.episodes[index].resume(restored);
            self.begun[index] = self.episodes[index].begun();
            // A state of a single environment knows no clock.
            self.over[index] |= self.episodes[index].end().is_some();
        }
        Ok(())
    }

    /// Steps all environments. Actions must have been checked.
    ///
    /// # Errors
    /// A file of a new trip cannot be loaded.
    pub fn step(&mut self, actions: Actions<'_>, results: &mut Results<'_>) -> PlantResult<Events> {
        let count = self.episodes.len();
        let Extras { costs, terms, masks } = &mut results.extras;
        let mut parts = results.parts.chunks_mut(count.max(1));
        let mut terms = terms.chunks_mut(count.max(1));
        let all = Batch {
            first: 0,
            episodes: &mut self.episodes,
            elapsed: &mut self.elapsed,
            over: &mut self.over,
            observations: results.observations,
            rewards: results.rewards,
            terminated: results.terminated,
            truncated: results.truncated,
            parts: std::array::from_fn(|_| parts.next().unwrap_or_default()),
            costs,
            terms: std::array::from_fn(|_| terms.next().unwrap_or_default()),
            masks,
        };
        let (autoreset, step_limit) = (self.autoreset, self.step_limit);
        let told = Mutex::default();
        self.threads.work(all, |batch: Batch<'_>| batch.step(actions, autoreset, step_limit, &told));
        let Told { mut events, errors } = told.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, error)) = errors.into_iter().min_by_key(|(index, _)| *index) {
            return Err(error);
        }
        events.finished.sort_unstable_by_key(|trip| trip.index);
        events.reset.sort_unstable();
        Ok(events)
    }

    /// Writes what the rule-based controllers would do next with the selected rows, environment by environment;
    /// nothing where no trip has begun.
    pub fn rule_based_actions(&mut self, actions: ActionsMut<'_>) {
        let Some(first) = self.episodes.first() else { return };
        let width = first.setup().actions.rows().len();
        match actions {
            ActionsMut::Levels(levels) => self.on_each(levels, width, Episode::rule_based_levels),
            ActionsMut::Values(values) => self.on_each(values, width, Episode::rule_based_values),
        }
    }

    /// Works on every environment and its entries of an array.
    fn on_each<T: Send>(
        &mut self,
        entries: &mut [T],
        width: usize,
        work: impl Fn(&mut Episode, &mut [T]) + Sync,
    ) {
        let all = Pairs { episodes: &mut self.episodes, entries, width };
        self.threads.work(all, |pairs: Pairs<'_, T>| {
            for (episode, entries) in pairs.episodes.iter_mut().zip(pairs.entries.chunks_mut(width)) {
                work(episode, entries);
            }
        });
    }
}

impl Batch<'_> {
    fn step(
        mut self,
        actions: Actions<'_>,
        autoreset: Autoreset,
        step_limit: Option<u64>,
        told: &Mutex<Told>,
    ) {
        let Some(first) = self.episodes.first() else { return };
        let width = first.setup().observations.rows().len();
        let mask_length = self.masks.len() / self.episodes.len();
        let mut masks = &mut *self.masks;
        let mut rest = &mut *self.episodes;
        for (place, observation) in self.observations.chunks_mut(width).enumerate() {
            let Some(episode) = rest.split_off_first_mut() else { return };
            let mut job = Job {
                index: self.first + place,
                episode,
                elapsed: &mut self.elapsed[place],
                over: &mut self.over[place],
                observation,
                reward: &mut self.rewards[place],
                terminated: &mut self.terminated[place],
                truncated: &mut self.truncated[place],
                mask: cut(&mut masks, mask_length),
                outcome: None,
                told,
                ahead: rest.get(AHEAD - 1),
            };
            job.work(actions, autoreset, step_limit);
            let outcome = job.outcome;
            let parts = outcome.map_or([0.0; PARTS], |outcome| outcome.parts);
            for (all, value) in self.parts.iter_mut().zip(parts) {
                all[place] = value;
            }
            if let Some(cost) = self.costs.get_mut(place) {
                *cost = outcome.map_or(0.0, |outcome| outcome.terms.cost());
            }
            if !self.terms[0].is_empty() {
                let terms = outcome.map_or([0.0; TERMS], |outcome| outcome.terms.values());
                for (all, value) in self.terms.iter_mut().zip(terms) {
                    all[place] = value;
                }
            }
        }
    }
}

impl Job<'_> {
    fn work(&mut self, actions: Actions<'_>, autoreset: Autoreset, step_limit: Option<u64>) {
        self.fetch_ahead(0);
        (*self.reward, *self.terminated, *self.truncated) = (0.0, false, false);
        // Where trips are reset within the step, one that is over comes from a restored state.
        if *self.over && autoreset != Autoreset::Disabled {
            self.begin();
        } else {
            self.step(actions, step_limit);
        }
        self.fetch_ahead(1);
        self.episode.observe(self.observation);
        if !self.mask.is_empty() {
            self.episode.write_mask(self.mask);
        }
        self.fetch_ahead(2);
        if *self.over
            && let Some(outcome) = self.outcome
        {
            self.finish(&outcome, autoreset);
        }
    }

    /// Asks for a share of what will be worked on soon.
    fn fetch_ahead(&self, share: usize) {
        if let Some(episode) = self.ahead {
            prefetch::<_, SHARES>(episode, share);
        }
    }

    fn begin(&mut self) {
        match self.episode.reset(None) {
            Ok(()) => {
                *self.elapsed = 0;
                *self.over = false;
                self.tell(|told| told.events.reset.push(self.index));
            }
            Err(error) => self.tell(|told| told.errors.push((self.index, error))),
        }
    }

    fn tell(&self, what: impl FnOnce(&mut Told)) {
        what(&mut self.told.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn step(&mut self, actions: Actions<'_>, step_limit: Option<u64>) {
        let table = &self.episode.setup().actions;
        let width = table.rows().len();
        let place = self.index * width..(self.index + 1) * width;
        let (mut few, mut many) = ([0.0; ACTUATOR_PLACES], Vec::new());
        let values = match actions {
            Actions::Values(all) => &all[place],
            Actions::Levels(all) => {
                // Cars that share an environment can have more rows together than one has.
                let values = few.get_mut(..width).unwrap_or_else(|| {
                    many.resize(width, 0.0);
                    &mut many
                });
                for (column, (value, &level)) in values.iter_mut().zip(&all[place]).enumerate() {
                    *value = table.value(column, level as usize);
                }
                &*values
            }
        };
        let Some(outcome) = self.episode.step(values) else { return };
        *self.elapsed += 1;
        *self.reward = outcome.reward;
        *self.terminated = outcome.end.is_some();
        *self.truncated = step_limit.is_some_and(|limit| *self.elapsed >= limit);
        *self.over = *self.terminated || *self.truncated;
        self.outcome = Some(outcome);
    }

    /// Tells of the end of a trip, and begins the next where that is wanted at once.
    #[cold]
    fn finish(&mut self, outcome: &Outcome, autoreset: Autoreset) {
        let Some(facts) = self.episode.facts() else { return };
        let mut finished = Finished {
            index: self.index,
            end: outcome.end,
            facts,
            terms: self.episode.terms().copied().unwrap_or_default(),
            totals: self.episode.totals(),
            parts: outcome.parts,
            last_terms: outcome.terms,
            last_seen: None,
        };
        if autoreset == Autoreset::SameStep {
            finished.last_seen =
                Some(LastSeen { observation: self.observation.to_vec(), mask: self.mask.to_vec() });
            self.outcome = None;
            self.begin();
            self.episode.observe(self.observation);
            if !self.mask.is_empty() {
                self.episode.write_mask(self.mask);
            }
        }
        self.tell(|told| told.events.finished.push(finished));
    }
}
