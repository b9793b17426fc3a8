// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include <fmt/format.h>

/// Transformers and their codes.
namespace gridspace::opendss {
namespace {

constexpr int kMaxWindings = 20;

struct TransformerReader {
    Transformer t;
    std::size_t winding{0};
    std::vector<std::pair<std::string, config::SourceMark>> buses{2};

    void resize(int windings) {
        auto const n = static_cast<std::size_t>(windings);
        t.windings.resize(n);
        buses.resize(n);
        t.x_pu.resize(std::max<std::size_t>(3, n * (n - 1) / 2), 0.3);
        winding = std::min(winding, n - 1);
    }
    WindingData& active() { return t.windings[winding]; }

    /// Values for the windings, one after the other.
    template <class Set>
    void each(Value const& v, Set set) {
        std::vector<Word> const words = v.words();
        if (words.size() > t.windings.size()) {
            v.wrong(fmt::format("has {} values for {} windings", words.size(), t.windings.size()),
                    "expected one for each winding; `windings` comes first");
            return;
        }
        for (std::size_t i = 0; i < words.size(); ++i) {
            set(i, words[i]);
        }
    }
    void load_loss(double percent) { t.windings[0].r_pu = t.windings[1].r_pu = percent / 200; }

    Meaning meaning(Object const& object, config::Diagnostics& diagnostics);
};

Meaning TransformerReader::meaning(Object const& object, config::Diagnostics& diagnostics) {
    auto const one = [this](double WindingData::* member, double scale = 1) {
        return [this, member, scale](Value const& v) { active().*member = v.number() * scale; };
    };
    auto const all = [this, &object, &diagnostics](double WindingData::* member, char const* name, bool positive,
                                                   double scale = 1) {
        return [=, this, &object, &diagnostics](Value const& v) {
            each(v, [&](std::size_t i, Word const& word) {
                Value const item{word, object, name, diagnostics};
                t.windings[i].*member = (positive ? item.positive() : item.number()) * scale;
            });
        };
    };
    auto const reactance = [this](std::size_t pair) {
        return [this, pair](Value const& v) {
            double const percent = v.number();
            if (percent == 0) {
                v.wrong("is 0", "expected a reactance in percent other than 0");
            }
            t.x_pu[pair] = percent / 100;
        };
    };
    return {{"phases", [this](Value const& v) { t.phases = v.integer(1, 3); }},
            {"windings", [this](Value const& v) { resize(v.integer(2, kMaxWindings)); }},
            {"wdg",
             [this](Value const& v) {
                 int const most = static_cast<int>(t.windings.size());
                 winding = static_cast<std::size_t>(v.integer(1, most)) - 1;
             }},
            {"bus", [this](Value const& v) { buses[winding] = {v.text(), v.where()}; }},
            {"buses",
             [this](Value const& v) {
                 each(v, [&](std::size_t i, Word const& word) { buses[i] = {word.value, word.where}; });
             }},
            {"conn", [this](Value const& v) { active().delta = v.delta(); }},
            {"conns",
             [this, &object, &diagnostics](Value const& v) {
                 each(v, [&](std::size_t i, Word const& word) {
                     t.windings[i].delta = Value{word, object, "conns", diagnostics}.delta();
                 });
             }},
            {"kv", [this](Value const& v) { active().kv = v.positive(); }},
            {"kvs", all(&WindingData::kv, "kvs", true)},
            {"kva",
             [this](Value const& v) {
                 double const kva = active().kva = v.positive();
                 if (winding == 0 || t.windings.size() == 2) { // the other windings are as large
                     for (WindingData& w : t.windings) {
                         w.kva = kva;
                     }
                 }
             }},
            {"kvas", all(&WindingData::kva, "kvas", true)},
            {"tap", one(&WindingData::tap)},
            {"taps", all(&WindingData::tap, "taps", false)},
            {"%r", one(&WindingData::r_pu, 0.01)},
            {"%rs", all(&WindingData::r_pu, "%rs", false, 0.01)},
            {"rneut", one(&WindingData::neutral_r_ohm)},
            {"xneut", one(&WindingData::neutral_x_ohm)},
            {"maxtap", one(&WindingData::most_tap)},
            {"mintap", one(&WindingData::least_tap)},
            {"numtaps", [this](Value const& v) { active().taps = v.integer(0, 10000); }},
            {"xhl", reactance(0)},
            {"x12", reactance(0)},
            {"xht", reactance(1)},
            {"x13", reactance(1)},
            {"xlt", reactance(2)},
            {"x23", reactance(2)},
            {"xscarray",
             [this](Value const& v) {
                 std::vector<double> const percent = v.list();
                 std::size_t const n = t.windings.size();
                 if (percent.size() != n * (n - 1) / 2) {
                     v.wrong(fmt::format("has {} values", percent.size()),
                             fmt::format("expected {}, one for each pair of windings", n * (n - 1) / 2));
                     return;
                 }
                 for (std::size_t i = 0; i < percent.size(); ++i) {
                     t.x_pu[i] = percent[i] / 100;
                 }
             }},
            {"%loadloss", [this](Value const& v) { load_loss(v.not_negative()); }},
            {"%noloadloss", [this](Value const& v) { t.no_load_pu = v.not_negative() / 100; }},
            {"%imag", [this](Value const& v) { t.magnetising_pu = v.not_negative() / 100; }},
            {"ppm_antifloat", [this](Value const& v) { t.float_share = v.not_negative() * 1e-6; }},
            {"leadlag", [this](Value const& v) {
                 std::string const word = lower(v.text());
                 t.high_leads = word.starts_with("lead") || word.starts_with("e");
             }}};
}

} // namespace

void Builder::transformer(Object const& object) {
    TransformerReader reader;
    Meaning meaning = reader.meaning(object, diagnostics_);
    meaning["xfmrcode"] = [&](Value const& v) {
        Object const* code = script_.find("xfmrcode", lower(v.text()));
        if (code == nullptr) {
            v.wrong(fmt::format("'{}' does not exist", v.text()), "expected the name of an xfmrcode");
            return;
        }
        TransformerReader of_code;
        replay(*code, of_code.meaning(*code, diagnostics_), diagnostics_);
        auto buses = std::move(reader.buses);
        reader.t = of_code.t;
        reader.buses = std::move(buses);
        reader.resize(static_cast<int>(reader.t.windings.size()));
    };
    replay(object, meaning, diagnostics_);
    Transformer const& t = reader.t;
    std::vector<int> nodes;
    for (std::size_t w = 0; w < t.windings.size(); ++w) {
        auto const& [bus, where] = reader.buses[w];
        if (bus.empty()) {
            error(object.where, fmt::format("transformer.{}: winding {} has no bus", object.name, w + 1));
            return;
        }
        std::vector<int> const terminal = connect(bus, where, t.phases, t.conductors());
        nodes.insert(nodes.end(), terminal.begin(), terminal.end());
    }
    Eigen::MatrixXcd y = t.admittance();
    if (y.size() == 0) {
        error(object.where, fmt::format("transformer.{} has impedances without an inverse", object.name),
              "expected reactances that fit each other");
        return;
    }
    std::size_t const place = circuit_.elements.size();
    add(object, std::move(nodes), t.conductors(), std::move(y));
    if (circuit_.elements.size() > place) {
        circuit_.transformers.emplace(place, t);
    }
}

} // namespace gridspace::opendss
