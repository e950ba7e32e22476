//! What everything was measured on, and when. Never lives here: measuring.

use rigd::adapter::AdapterInfo;
use std::fmt;
use std::time::{SystemTime, UNIX_EPOCH};

pub struct Machine {
    processor: String,
    cores: usize,
    adapter: String,
    date: String,
}

impl Machine {
    pub fn with(adapter: &AdapterInfo) -> Self {
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = info.lines().find(|line| line.starts_with("model name"));
        let model = model.and_then(|line| line.split_once(": "));
        let known = AdapterInfo {
            why: None,
            ..adapter.clone()
        };
        Self {
            processor: model
                .map_or("an unknown processor", |(_, name)| name)
                .to_owned(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            adapter: known.to_string(),
            date: today(),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            processor,
            cores,
            adapter,
            date,
        } = self;
        write!(
            f,
            "Measured on {date}, on {processor}, {cores} cores, drawing with {adapter}."
        )
    }
}

/// Year, month and day in UTC, by the calendar of 400 years that each have 146,097 days, counted from 1 March so that the leap day
/// comes last.
fn today() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let days = since.map_or(0, |since| since.as_secs() / 86_400) + 719_468;
    let day_of_era = days % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let (month, later) = if month < 10 {
        (month + 3, 0)
    } else {
        (month - 9, 1)
    };
    let year = year_of_era + 400 * (days / 146_097) + later;
    format!("{year}-{month:02}-{day:02}")
}
