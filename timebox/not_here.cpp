// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/box.hpp"

namespace gridspace::timebox {

struct Box::Impl {};
Box::Box(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}
Box::~Box() = default;

Result<std::unique_ptr<Box>> Box::start(BoxOptions) {
    return std::unexpected{try_here().error()};
}
Result<Box::Pause> Box::run_until(std::optional<std::int64_t>) {
    return Pause::ended;
}
std::optional<std::int64_t> Box::next_ns() const {
    return std::nullopt;
}
void Box::arrives(std::int64_t, std::span<std::byte const>) {}
void Box::hand(std::int64_t, std::vector<std::byte>) {}
void Box::ask_to_end() {}
BoxReport Box::report() const {
    return {};
}
bool Box::can_look_inside() const {
    return false;
}
Result<BoxReport> try_here() {
    return fail(ExitCode::environment, "programs in simulated time run on x86-64 only");
}

} // namespace gridspace::timebox
