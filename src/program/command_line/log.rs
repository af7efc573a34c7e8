//! The log of the program, on standard error.

use env_logger::{Builder, DEFAULT_FILTER_ENV, Env, Logger};
use log::{Log, Metadata, Record};
use talcum_engine::parallel::is_on_root;

/// The common log of ranks that are threads; unless RUST_LOG requests all ranks, rank 0 writes it.
struct LogOfRanks {
    logger: Logger,
    of_all: bool,
}

impl Log for LogOfRanks {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        (self.of_all || is_on_root()) && self.logger.enabled(metadata)
    }

    fn log(&self, record: &Record<'_>) {
        if self.enabled(record.metadata()) {
            self.logger.log(record);
        }
    }

    fn flush(&self) {
        self.logger.flush();
    }
}

/// Starts the log of this process, down to a given level unless RUST_LOG sets one.
pub(super) fn start_log(level: &str) {
    let environment = Env::default().default_filter_or(level);
    let logger = Builder::from_env(environment).format_timestamp(None).format_target(false).build();
    log::set_max_level(logger.filter());
    let of_all = std::env::var_os(DEFAULT_FILTER_ENV).is_some();
    // A process starts its log once.
    let _ = log::set_boxed_logger(Box::new(LogOfRanks { logger, of_all }));
}
