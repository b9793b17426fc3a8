// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The source of a mapping without `from`: constants, and what they become at times of the run.
#include "gateways/gateway/source.hpp"

namespace gridspace::gateways {
namespace {

class ConstantSource final : public Source {
  public:
    ConstantSource(Route& route, Sink& sink, WireClock const& clock, double speed)
        : Source{route, sink}, clock_{clock}, speed_{speed} {}

    [[nodiscard]] std::optional<std::int64_t> deadline() const override {
        if (next_ < route_.changes.size() && !due_ns_) { // in real time: as soon as it is known when the run began
            due_ns_ = clock_.when(route_.changes[next_].at_s, speed_);
        }
        return next_ < route_.changes.size() ? due_ns_ : std::nullopt;
    }

    void expire(Moment at) override {
        for (auto const& [field, value] : route_.changes[next_].values) {
            sink_.values()[field] = value;
        }
        ++next_;
        due_ns_.reset();
        sink_.put(at, 0);
        if (observer_.mapped) {
            observer_.mapped(at, sink_.values());
        }
    }

  private:
    WireClock const& clock_;
    double speed_;
    std::size_t next_{0};
    mutable std::optional<std::int64_t> due_ns_; ///< of the next change
};

} // namespace

std::unique_ptr<Source> make_constant_source(Route& route, Sink& sink, WireClock const& clock, double speed) {
    return std::make_unique<ConstantSource>(route, sink, clock, speed);
}

} // namespace gridspace::gateways
