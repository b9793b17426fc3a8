// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/engine/engine.hpp"

#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace gridspace::sim {

/// An engine around another: it adds signals to those of the inner one, and hands on the rest.
class WrappedEngine : public Engine {
  public:
    [[nodiscard]] Result<void> initialise() override { return inner_->initialise(); }
    [[nodiscard]] std::vector<SignalDef> const& signals() const final { return signals_; }
    [[nodiscard]] double value(std::size_t signal) const final {
        std::size_t const inner = signals_.size() - own_.size();
        return signal < inner ? inner_->value(signal) : own_[signal - inner]();
    }
    void will_read(std::span<std::size_t const> signals) final {
        std::vector<std::size_t> all;
        for (std::size_t const s : signals) {
            if (s < signals_.size() - own_.size()) {
                all.push_back(s);
            }
        }
        all.insert(all.end(), measured_.begin(), measured_.end());
        inner_->will_read(all);
    }
    [[nodiscard]] std::span<Happening const> happened() const override { return inner_->happened(); }

  protected:
    explicit WrappedEngine(std::unique_ptr<Engine> inner) : inner_{std::move(inner)}, signals_{inner_->signals()} {}
    [[nodiscard]] Engine& inner() const { return *inner_; }
    void add_signal(SignalDef signal, std::function<double()> read) {
        signals_.push_back(std::move(signal));
        own_.push_back(std::move(read));
    }
    /// A signal of the inner engine that this one reads.
    [[nodiscard]] std::size_t measure(std::string const& signal) {
        measured_.push_back(inner_->find_signal(signal));
        return measured_.back();
    }

  private:
    std::unique_ptr<Engine> inner_;
    std::vector<SignalDef> signals_;
    std::vector<std::function<double()>> own_; ///< the last ones of signals_
    std::vector<std::size_t> measured_;
};

} // namespace gridspace::sim
