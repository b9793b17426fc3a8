// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace gridspace::dataset {

/// The ground truth of a run, 32 octets for each altered phase-sample or message.
class LabelTable {
  public:
    struct Label {
        std::int64_t index{0};
        std::uint16_t attack{0}; ///< of attacks()
        std::uint8_t channel{0};
        double true_value{0}, sent_value{0};
    };

    void add(std::string const& attack, std::string const& kind, std::string const& target, Label label) {
        auto const at =
            std::find_if(attacks_.begin(), attacks_.end(), [&](Attack const& a) { return a.name == attack; });
        label.attack = static_cast<std::uint16_t>(at - attacks_.begin());
        if (at == attacks_.end()) {
            attacks_.push_back({attack, kind, target, 0});
        }
        ++attacks_[label.attack].labels;
        by_target_[target].push_back(label);
    }
    /// Before the first question.
    void sort() {
        for (auto& [target, labels] : by_target_) {
            std::stable_sort(labels.begin(), labels.end(), [](Label const& a, Label const& b) {
                return std::pair{a.index, a.channel} < std::pair{b.index, b.channel};
            });
        }
    }

    struct Attack {
        std::string name, kind, target;
        std::uint64_t labels{0};
    };
    [[nodiscard]] std::vector<Attack> const& attacks() const { return attacks_; }
    [[nodiscard]] std::map<std::string, std::vector<Label>> const& by_target() const { return by_target_; }

    /// What was altered of one sample; nothing of one that was not.
    [[nodiscard]] std::span<Label const> of_sample(std::string const& stream, std::int64_t index) const {
        auto const labels = by_target_.find(stream);
        if (labels == by_target_.end()) {
            return {};
        }
        auto const less = [](Label const& a, Label const& b) { return a.index < b.index; };
        Label wanted;
        wanted.index = index;
        auto const [from, to] = std::equal_range(labels->second.begin(), labels->second.end(), wanted, less);
        return {from, to};
    }

  private:
    std::vector<Attack> attacks_;
    std::map<std::string, std::vector<Label>> by_target_;
};

} // namespace gridspace::dataset
