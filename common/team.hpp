// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

namespace gridspace {

/// Who does the parts of a calculation at the same time. A core that is given a team knows no threads: it says which
/// parts do not depend on each other. What they compute must not depend on who does which, so that any team gives the
/// same bits.
class Team {
  public:
    virtual ~Team() = default;
    /// Parts that are done at once, at least 1.
    [[nodiscard]] virtual int size() const = 0;
    /// Does each of the parts 0 to size() - 1 once and returns when all are done: what they wrote is there then. A part
    /// neither throws nor calls the team. Allocates nothing.
    template <class Part>
    void run(Part const& part) {
        do_parts([](void const* p, int k) { (*static_cast<Part const*>(p))(k); }, &part);
    }

  protected:
    using Call = void (*)(void const* context, int part);
    virtual void do_parts(Call call, void const* context) = 0;
};

/// The calling thread and `threads` - 1 others, which end with the team. Who waits spins for some microseconds, then
/// yields, then sleeps. A part whose thread has no processor is done by another, so nobody waits for a thread that has
/// not begun. `threads`: at least 1.
[[nodiscard]] std::unique_ptr<Team> make_thread_team(int threads);

} // namespace gridspace
