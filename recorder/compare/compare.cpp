// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/compare/compare.hpp"

#include "common/idl/cdr_visitor.hpp"
#include "common/text.hpp"
#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/signals/signal_store.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace gridspace {
namespace {

struct Sample {
    std::uint64_t time_ns;
    std::vector<std::byte> data;
};

/// All samples of a recording by (topic, process), in order, with the types they have.
struct Recording {
    std::map<std::pair<std::string, std::string>, std::vector<Sample>> samples;
    std::map<std::string, std::pair<std::string, std::string>> types; ///< topic -> (type, IDL)
    std::string note;
};

Result<Recording> load(std::filesystem::path const& file, std::vector<std::string> const& skip) {
    Recording out;
    auto const outcome = mcap::read_messages(file, [&](mcap::Message const& m) {
        if (std::find(skip.begin(), skip.end(), m.channel.topic) == skip.end()) {
            auto const process = m.channel.metadata.find("process");
            out.samples[{m.channel.topic, process == m.channel.metadata.end() ? "" : process->second}].push_back(
                {m.time_ns, {m.data.begin(), m.data.end()}});
            out.types.try_emplace(m.channel.topic, m.schema.name, m.schema.data);
        }
        return true;
    });
    if (!outcome) {
        return std::unexpected{outcome.error()};
    }
    out.note = outcome->note;
    return out;
}

bool earlier(Difference const& p, Difference const& q) {
    return p.time_ns < q.time_ns;
}

/// The leaves of a sample as (path, value).
struct Leaves final : idl::Visitor {
    std::vector<std::pair<std::string, idl::Value>> values;
    void leaf(std::string_view path, idl::Type const&, idl::Value const& value) override {
        values.emplace_back(path, value);
    }
};

bool close(idl::Value const& a, idl::Value const& b, double tolerance) {
    double const x = idl::to_number(a), y = idl::to_number(b);
    if (std::isnan(x) || std::isnan(y)) {
        return a == b || (std::isnan(x) && std::isnan(y));
    }
    return std::abs(x - y) <= tolerance * std::max(1.0, std::max(std::abs(x), std::abs(y)));
}

/// What differs between two samples of a type; empty when it is within the tolerance.
std::string difference(std::pair<std::string, std::string> const& type, Sample const& a, Sample const& b,
                       double tolerance) {
    auto const model = idl::parse(type.second);
    auto const index = model ? model->find(type.first) : std::nullopt;
    if (!index) {
        return "the octets differ";
    }
    Leaves left, right;
    if (!visit(*model, *index, a.data, left) || !visit(*model, *index, b.data, right)) {
        return "the octets differ";
    }
    for (std::size_t i = 0; i < std::min(left.values.size(), right.values.size()); ++i) {
        auto const& [path, x] = left.values[i];
        auto const& [other_path, y] = right.values[i];
        if (path != other_path) {
            return fmt::format("{} stands against {}", path, other_path);
        }
        bool const same = tolerance > 0 ? close(x, y, tolerance) : x == y;
        if (!same) {
            return fmt::format("{} is {} and {}", path, idl::to_text(x), idl::to_text(y));
        }
    }
    if (left.values.size() != right.values.size()) {
        return fmt::format("{} values stand against {}", left.values.size(), right.values.size());
    }
    return tolerance > 0 ? "" : "the octets differ, the values do not (padding or text behind its end)";
}

Result<Comparison> compare_samples(std::filesystem::path const& a, std::filesystem::path const& b,
                                   CompareOptions const& options) {
    auto left = load(a, options.skip_topics);
    if (!left) {
        return std::unexpected{left.error()};
    }
    auto right = load(b, options.skip_topics);
    if (!right) {
        return std::unexpected{right.error()};
    }
    Comparison out;
    for (auto const& [recording, file] : {std::pair{&*left, a}, {&*right, b}}) {
        if (!recording->note.empty()) {
            out.notes.push_back(fmt::format("{}: {}", file.string(), recording->note));
        }
    }
    auto keys = left->samples;
    for (auto const& [key, samples] : right->samples) {
        keys.try_emplace(key);
    }
    for (auto const& [key, unused] : keys) {
        auto const& x = left->samples[key];
        auto const& y = right->samples[key];
        auto const note = [&](std::uint64_t time, std::string what) {
            out.differences.push_back({key.first, key.second, time, std::move(what)});
        };
        std::size_t const common = std::min(x.size(), y.size());
        bool differs = false;
        for (std::size_t i = 0; i < common && !differs; ++i) {
            ++out.samples;
            if (x[i].time_ns != y[i].time_ns) {
                note(std::min(x[i].time_ns, y[i].time_ns),
                     fmt::format("sample {} is at {} ns and at {} ns", i + 1, x[i].time_ns, y[i].time_ns));
                differs = true;
            } else if (x[i].data != y[i].data) {
                std::string what = difference(left->types[key.first], x[i], y[i], options.tolerance);
                if (!what.empty()) {
                    note(x[i].time_ns, fmt::format("sample {}: {}", i + 1, what));
                    differs = true;
                }
            }
        }
        if (!differs && x.size() != y.size()) {
            auto const& longer = x.size() > y.size() ? x : y;
            note(longer[common].time_ns, fmt::format("{} samples and {} samples", x.size(), y.size()));
        }
    }
    std::stable_sort(out.differences.begin(), out.differences.end(), earlier);
    return out;
}

Result<Comparison> compare_signals(std::filesystem::path const& a, std::filesystem::path const& b,
                                   CompareOptions const& options) {
    auto const wanted = [&](std::string const& name) {
        return std::any_of(options.signals.begin(), options.signals.end(),
                           [&](std::string const& p) { return matches_glob(p, name); });
    };
    auto left = read_signals(a, wanted);
    if (!left) {
        return std::unexpected{left.error()};
    }
    auto right = read_signals(b, wanted);
    if (!right) {
        return std::unexpected{right.error()};
    }
    Comparison out;
    if (left->empty() && right->empty()) {
        return fail(ExitCode::usage, fmt::format("no recorded signal matches {}", join(options.signals, ", ")),
                    "`gridspace signals SCENARIO` lists them");
    }
    SignalStore all = *left;
    all.insert(right->begin(), right->end());
    for (auto const& [name, unused] : all) {
        SignalSeries const& x = (*left)[name];
        SignalSeries const& y = (*right)[name];
        std::size_t const common = std::min(x.values.size(), y.values.size());
        std::size_t i = 0;
        for (; i < common; ++i) {
            ++out.samples;
            if (x.times_ns[i] != y.times_ns[i] ||
                !close(idl::Value{x.values[i]}, idl::Value{y.values[i]}, options.tolerance)) {
                out.differences.push_back({name, "", static_cast<std::uint64_t>(std::min(x.times_ns[i], y.times_ns[i])),
                                           x.times_ns[i] == y.times_ns[i]
                                               ? fmt::format("{} and {}", shortest(x.values[i]), shortest(y.values[i]))
                                               : fmt::format("at {} ns and at {} ns", x.times_ns[i], y.times_ns[i])});
                break;
            }
        }
        if (i == common && x.values.size() != y.values.size()) {
            auto const& longer = x.values.size() > y.values.size() ? x : y;
            out.differences.push_back({name, "", static_cast<std::uint64_t>(longer.times_ns[common]),
                                       fmt::format("{} values and {} values", x.values.size(), y.values.size())});
        }
    }
    std::stable_sort(out.differences.begin(), out.differences.end(), earlier); // of one instant by name
    return out;
}

} // namespace

Result<Comparison> compare_recordings(std::filesystem::path const& a, std::filesystem::path const& b,
                                      CompareOptions const& options) {
    return options.signals.empty() ? compare_samples(a, b, options) : compare_signals(a, b, options);
}

} // namespace gridspace
