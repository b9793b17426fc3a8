// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"
#include "common/text.hpp"
#include "launcher/sweep/study.hpp"
#include "launcher/sweep/table_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;
using Kind = Distribution::Kind;

constexpr std::array<std::string_view, 8> kSources{"values",  "range",       "files",  "csv",
                                                   "uniform", "log_uniform", "normal", "triangular"};

/// As a person writes it: 0.1 times 3 is 0.3.
Node number_node(double value, config::SourceMark where) {
    return Node::scalar(fmt::format("{:.12g}", value), std::move(where));
}

void read_range(Fields& g, std::vector<Node>& values) {
    double from = 0, to = 0, step = 0;
    std::int64_t count = 0;
    g.number("from", from, {.doc = "first value", .required = true});
    g.number("to", to, {.doc = "last value; with `step` it may be passed over", .required = true});
    g.number("step", step, {.doc = "from one value to the next", .above = 0});
    g.integer("count", count, {.doc = "how many values, instead of `step`", .min = 2, .max = kMaxStudyRuns});
    if (g.has("step") == g.has("count")) {
        g.error("", "a range has either `step` or `count`", "from, to and step; or from, to and count");
        return;
    }
    if (to < from) {
        g.error("to", fmt::format("the range from {} to {} is empty", shortest(from), shortest(to)),
                "`to` is not below `from`");
        return;
    }
    double const places = step > 0 ? std::floor((to - from) / step + 1e-9) : static_cast<double>(count - 1);
    if (places >= static_cast<double>(kMaxStudyRuns)) {
        g.error("", fmt::format("the range has {:.0f} values", places + 1), fmt::format("at most {}", kMaxStudyRuns));
        return;
    }
    double const width = step > 0 ? step : (to - from) / static_cast<double>(std::max<std::int64_t>(count - 1, 1));
    for (double i = 0; i <= places; ++i) {
        values.push_back(number_node(from + i * width, g.where()));
    }
}

void read_distribution(Fields& g, Kind kind, std::optional<Distribution>& out) {
    Distribution d;
    d.kind = kind;
    bool const normal = kind == Kind::normal;
    if (normal) {
        g.number("mean", d.mean, {.doc = "mean value", .required = true});
        g.number("deviation", d.deviation, {.doc = "standard deviation", .required = true, .above = 0});
    }
    double const above = kind == Kind::log_uniform ? 0 : -std::numeric_limits<double>::infinity();
    g.number("low", d.low,
             {.doc = normal ? "smaller draws do not occur" : "smallest value", .required = !normal, .above = above});
    g.number("high", d.high, {.doc = normal ? "larger draws do not occur" : "largest value", .required = !normal});
    if (kind == Kind::triangular) {
        g.number("mode", d.mode, {.doc = "most likely value", .required = true});
    }
    if (!(d.low < d.high)) {
        g.error("high", fmt::format("nothing lies between {} and {}", shortest(d.low), shortest(d.high)),
                "`low` is below `high`");
    } else if (kind == Kind::triangular && (d.mode < d.low || d.mode > d.high)) {
        g.error("mode",
                fmt::format("{} is not between {} and {}", shortest(d.mode), shortest(d.low), shortest(d.high)));
    } else if (constexpr double kLeastShare = 1e-9; normal && d.deviation > 0 && normal_share(d) < kLeastShare) {
        g.error("low",
                fmt::format("of draws with mean {} and deviation {} none lies between {} and {}", shortest(d.mean),
                            shortest(d.deviation), shortest(d.low), shortest(d.high)),
                "bounds nearer to the mean");
    } else {
        out = d;
    }
}

/// `set:` of a parameter: one path, or a list of them.
void read_paths(Fields& f, Parameter& p) {
    Node set;
    f.raw("set", set,
          {.doc = "path of the value in the scenario (processes.ev1.requested_h), or a list of such paths",
           .required = true});
    if (set.is_null()) {
        return;
    }
    for (Node const& path : set.is_sequence() ? set.items : std::vector<Node>{set}) {
        std::vector<std::string> const parts = split(path.is_scalar() ? path.text : "", '.');
        if (parts.empty() || std::any_of(parts.begin(), parts.end(), [](auto const& part) { return part.empty(); })) {
            f.error("set", fmt::format("{} is not a path", describe(path)),
                    "keys joined by dots: processes.ev1.requested_h");
        } else {
            p.paths.push_back({path.text, path.where});
        }
    }
    if (set.is_sequence() && set.items.empty()) {
        f.error("set", "the list of paths is empty");
    }
}

void describe(Fields& f, Parameter& p) {
    read_paths(f, p);
    Node values;
    f.raw("values", values, {.doc = "a list of values: numbers, words, lists, maps; ~ removes what stands there"});
    if (values.is_sequence() && !values.items.empty()) {
        p.values = values.items;
    } else if (!values.is_null()) {
        f.error("values", values.is_sequence() ? "the list of values is empty"
                                               : "expected a list of values, for example [1, 2, 3]");
    }
    f.object("range", {.doc = "numbers at equal distances"}, [&](Fields& g) { read_range(g, p.values); });
    std::vector<Ref> files;
    f.references("files", files, {.doc = "names of files, relative to this one"});
    for (Ref const& file : files) {
        auto const base = std::filesystem::path{file.where.source == nullptr ? "." : file.where.source->directory};
        auto const path = std::filesystem::absolute(base / file.name).lexically_normal();
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(path, ignored)) {
            f.error("files", fmt::format("there is no file '{}'", path.string()));
        }
        p.values.push_back(Node::scalar(path.string(), file.where));
    }
    std::filesystem::path csv;
    std::string column;
    f.file("csv", csv, {.doc = "a table: the values are one of its columns"});
    f.text("column", column, {.doc = "name of that column; the parameter's own when not given"});
    if (column.empty()) {
        column = p.name.name;
    }
    if (!csv.empty()) {
        if (auto const cells = read_column(csv, column, kMaxStudyRuns)) {
            for (std::string const& cell : *cells) {
                p.values.push_back(Node::scalar(cell, f.where("csv")));
            }
        } else {
            f.error("csv", cells.error().message, cells.error().remedy);
        }
    } else if (f.has("column")) {
        f.error("column", "a column of what?", "it goes with `csv: FILE`");
    }
    for (auto const& [key, kind, doc] :
         {std::tuple{"uniform", Kind::uniform, "drawn, every value as likely"},
          {"log_uniform", Kind::log_uniform, "drawn, every order of magnitude as likely"},
          {"normal", Kind::normal, "drawn from a normal distribution"},
          {"triangular", Kind::triangular, "drawn from a triangular distribution"}}) {
        f.object(key, {.doc = doc}, [&](Fields& g) { read_distribution(g, kind, p.distribution); });
    }
    f.number("round_to", p.round_to, {.doc = "draws become multiples of this: 1 for whole numbers", .above = 0});
    std::vector<std::string> given;
    for (std::string_view const source : kSources) {
        if (f.has(source)) {
            given.push_back("`" + std::string{source} + "`");
        }
    }
    if (given.size() != 1) {
        std::vector<std::string> const names{kSources.begin(), kSources.end()};
        f.error("",
                given.empty() ? fmt::format("'{}' has no values", p.name.name)
                              : fmt::format("'{}' has {}", p.name.name, join(given, " and ")),
                fmt::format("expected exactly one of: {}", join(names, ", ")));
    } else if (f.has("round_to") && !p.distribution) {
        f.error("round_to", "only draws are rounded");
    }
}

void describe(Fields& f, Study& s) {
    std::int64_t version = 1;
    f.integer("gridspace_study", version, {.doc = "version of this format", .required = true, .min = 1, .max = 1});
    f.text("name", s.name, {.doc = "name of the study; also of its folder", .required = true});
    if (!s.name.empty() && !is_identifier(s.name)) {
        f.error("name", fmt::format("'{}' cannot be the name of a study", s.name),
                "letters, digits and _, not starting with a digit");
    }
    f.text("description", s.description, {.doc = "what it is about"});
    f.file("scenario", s.scenario, {.doc = "the scenario that is run", .required = true});
    s.scenario_mark = f.where("scenario");
    f.raw("set", s.set, {.doc = "values for all runs by their path: {processes.monitor: ~, simulation.duration_h: 1}"});
    if (!s.set.is_null() && !s.set.is_map()) {
        f.error("set", "expected a map from paths to values", "for example {processes.monitor: ~}");
        s.set = Node{};
    }
    s.parameters_mark = f.where("vary");
    f.map("vary", {.doc = "what varies, by name; each name is a column of the table"}, [&](Ref const& name, Fields& g) {
        Parameter p;
        p.name = name;
        describe(g, p);
        s.parameters.push_back(std::move(p));
    });
    f.choice<Study::Combine>("combine", s.combine, {{"cross", Study::Combine::cross}, {"zip", Study::Combine::zip}},
                             {.doc = "cross: every value with every other; zip: the first with the first, and so on"});
    f.object("sampling", {.doc = "how draws are made"}, [&](Fields& g) {
        g.choice<bool>("method", s.sampling.latin_hypercube, {{"latin_hypercube", true}, {"random", false}},
                       {.doc = "latin_hypercube: each parameter has one draw in each of `samples` equally likely parts "
                               "of its range"});
        g.integer("samples", s.sampling.samples, {.doc = "how many draws", .min = 1, .max = kMaxStudyRuns});
        g.integer("seed", s.sampling.seed, {.doc = "of the draws"});
    });
    f.references("where", s.where,
                 {.doc = "conditions over what varies (\"vary.low_kw < vary.high_kw\"); points that do not meet all of "
                         "them are left out"});
    f.integer("repetitions", s.repetitions,
              {.doc = "runs of each point; the second has the scenario's seed plus 1, and so on",
               .min = 1,
               .max = kMaxStudyRuns});
    std::vector<Ref> expectations;
    f.references("expectations", expectations,
                 {.doc = "expectations of the scenario that are judged, and columns of the table; all when not given"});
    if (f.has("expectations")) {
        s.expectations = std::move(expectations);
    }
    f.raw("results", s.results,
          {.doc = "further columns, by name, written as in `expect:` of a scenario; without limits they are shown and "
                  "not judged"});
    if (!s.results.is_null() && !s.results.is_map()) {
        f.error("results", "expected a map from names to what they are", "for example {v_min: {min_of: bus.*.v_pu}}");
        s.results = Node{};
    }
    std::vector<Ref> depends;
    f.references(
        "depends_on", depends,
        {.doc =
             "files and folders that programs of yours read by themselves: when one changes, the runs are done again"});
    for (Ref const& name : depends) {
        auto const base = std::filesystem::path{name.where.source == nullptr ? "." : name.where.source->directory};
        s.depends_on.push_back(std::filesystem::absolute(base / name.name).lexically_normal());
        std::error_code ignored;
        if (!std::filesystem::exists(s.depends_on.back(), ignored)) {
            f.error("depends_on", fmt::format("there is no '{}'", s.depends_on.back().string()));
        }
    }
}

bool lies_over(std::string const& a, std::string const& b) {
    return a == b || b.starts_with(a + ".");
}

/// What two parameters, or a parameter and `set`, say of the same value.
void check_paths(Study const& s, Diagnostics& diagnostics) {
    struct Written {
        std::string path, by;
    };
    std::vector<Written> written;
    auto const add = [&](std::string const& path, std::string const& by, config::SourceMark const& where) {
        for (Written const& other : written) {
            if (lies_over(other.path, path) || lies_over(path, other.path)) {
                diagnostics.error(where, fmt::format("'{}' is already set by {}", path, other.by),
                                  other.path == "expect" ? "`expectations: []` judges none of the scenario's"
                                                         : "one of them would have no effect",
                                  static_cast<int>(path.size() - (path.starts_with("expect.") ? 7 : 0)));
                return;
            }
        }
        written.push_back({path, by});
    };
    for (Node::Entry const& entry : s.set.entries) {
        add(entry.key, "`set`", entry.where);
    }
    for (Parameter const& p : s.parameters) {
        for (Ref const& path : p.paths) {
            add(path.name, fmt::format("'{}'", p.name.name), path.where);
        }
    }
    for (Node::Entry const& entry : s.results.entries) {
        add("expect." + entry.key, "`results`", entry.where);
    }
    for (Written const& one : written) {
        if (lies_over("seed", one.path) && s.repetitions > 1) {
            diagnostics.error(s.parameters_mark, fmt::format("{} sets the seed, and so do the repetitions", one.by),
                              "leave one of them out");
        }
    }
}

} // namespace

bool is_drawn(Node const& parameter) {
    constexpr std::size_t kListed = 4; // values, range, files, csv
    return std::any_of(kSources.begin() + kListed, kSources.end(),
                       [&](std::string_view source) { return parameter.find(source) != nullptr; });
}

void describe_study_keys(config::Fields& fields) {
    Study study;
    describe(fields, study);
}

std::optional<Study> load_study(std::filesystem::path const& file, Diagnostics& diagnostics) {
    auto const root = config::load_extended(file, diagnostics);
    if (!root) {
        return std::nullopt;
    }
    for (auto const& [key, what] : {std::pair{"gridspace", "a scenario"},
                                    {"gridspace_network", "a network file"},
                                    {"gridspace_certify", "a case of a certification"}}) {
        if (Node::Entry const* version = root->find_entry(key)) {
            diagnostics.error(version->where, fmt::format("this is {}, and a study is expected", what),
                              "a study names a scenario and what varies: docs/reference/sweep.md");
            return std::nullopt;
        }
    }
    return read_study(*root, file, diagnostics);
}

std::optional<Study> read_study(Node const& root, std::filesystem::path const& file, Diagnostics& diagnostics) {
    Study study;
    study.file = file;
    int const before = diagnostics.errors();
    config::read_fields(root, "", diagnostics, [&](Fields& f) { describe(f, study); });
    check_paths(study, diagnostics);
    if (diagnostics.errors() > before) {
        return std::nullopt;
    }
    study.scenario = std::filesystem::absolute(study.scenario).lexically_normal();
    return study;
}

} // namespace gridspace::launcher
