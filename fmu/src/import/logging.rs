//! What FMUs say: the last messages of an instance, kept so that an error can carry them.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use super::status::Status;

/// Messages kept of one instance: an FMU that logs at every step must not fill the memory.
const KEPT: usize = 200;

/// One message of an FMU.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// How serious the FMU thinks it is.
    pub status: Status,
    /// One of the FMU's log categories.
    pub category: String,
    pub text: String,
}

/// The last messages of an instance. FMUs may log from threads of their own.
#[derive(Debug, Default)]
pub(crate) struct Log {
    messages: Mutex<VecDeque<Message>>,
}

impl Log {
    pub(crate) fn push(&self, message: Message) {
        let mut messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        if messages.len() == KEPT {
            // What went wrong is worth more than what went on.
            let chatter = messages.iter().position(|message| message.status == Status::Ok);
            messages.remove(chatter.unwrap_or(0));
        }
        messages.push_back(message);
    }

    /// Takes all messages, oldest first.
    pub(crate) fn take(&self) -> Vec<Message> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).drain(..).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_messages_are_kept() {
        let log = Log::default();
        for k in 0..KEPT + 5 {
            let text = k.to_string();
            log.push(Message { status: Status::Ok, category: String::new(), text });
        }
        let kept = log.take();
        assert_eq!((kept.len(), kept[0].text.as_str()), (KEPT, "5"));
        assert!(log.take().is_empty());
        log.push(Message { status: Status::Warning, category: String::new(), text: "w".into() });
        for _ in 0..2 * KEPT {
            log.push(Message { status: Status::Ok, category: String::new(), text: "o".into() });
        }
        let kept = log.take();
        assert_eq!(
            (kept.len(), kept[0].text.as_str()),
            (KEPT, "w"),
            "chatter drives no warning out"
        );
    }
}
