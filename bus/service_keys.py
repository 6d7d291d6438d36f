"""Keys outside the topic table: simulated time, what is kept for late readers, and what people ask."""

RELEASE, DONE, HELLO = "clock/release", "clock/done", "clock/hello"
"""Key prefixes of simulated time; the process's name follows. HELLO: the process is ready, or ready again after a
restart."""

NOW = "clock/now"
"""On the monotonic clock the process of io answers with the run's time, by which other machines set theirs."""

KEPT = "kept"
"""Key prefix; a topic's key follows. The process of io answers with the last messages of that topic."""

RELIEF_ASK, RELIEF_ANSWER = "relief/ask", "relief/answer"
"""Key prefixes; a process's name follows. How one process leaves its place to the next on the monotonic clock."""

LOG = "log"
"""Key prefix; a process's name follows. What it has read and published, for a recorder."""

REQUEST = "operator/request"
"""People's commands to the process of io, which dates and numbers them."""

TUNE = "operator/tune"
"""People's changes of settings to the process of io, which checks, dates and numbers them: `section.key=value`."""

REFUSED = "operator/refused"
"""Requests that have not become commands, with the reason. No topic: nothing of the run follows from them."""

BEAT = "operator/beat"
"""The operator's side says that it is there. No topic: only its absence counts, which becomes a command."""

DEPLOYMENT = "deployment"
"""The process of io answers with the resolved configuration."""

SUPERVISOR_REQUEST = "supervisor/request"
"""What people ask of the supervisor: "restart NAME", "stop", or "lend NAME PID"."""
