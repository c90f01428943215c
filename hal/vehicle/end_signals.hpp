// The signals that end the daemon in order: the arm stops, loses power, and its nodes are stopped.
#pragma once

namespace lf::hal {

// A signalfd that is readable once SIGINT, SIGTERM or SIGHUP came. They are blocked from now on, in this thread and in those that it starts later: they are
// taken between two looks, never in a handler. Before threads are started. The caller closes the descriptor.
int take_end_signals();

}  // namespace lf::hal
