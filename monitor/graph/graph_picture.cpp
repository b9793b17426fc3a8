// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "monitor/graph/graph_text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace gridspace::graph {
namespace {

std::string quoted(std::string const& text) {
    std::string out = "\"";
    for (char const c : text) {
        out += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    }
    return out + "\"";
}

/// What both pictures show: arrows from writers to topics to readers, streams of raw frames in the same way.
struct Arrow {
    std::string process, middle; ///< middle: the topic or stream
    bool out{false};             ///< from the process
    bool wire{false};
    std::vector<std::string> problems;
};

std::vector<Arrow> arrows_of(Snapshot const& graph, bool framework) {
    std::vector<Arrow> out;
    for (Edge const& e : graph.edges) {
        bool const own = std::any_of(graph.topics.begin(), graph.topics.end(),
                                     [&](Topic const& t) { return t.name == e.topic && t.framework; });
        if (framework || !own) {
            out.push_back({e.process, e.topic, e.writes, false, e.problems});
        }
    }
    for (WireEdge const& w : graph.wires) {
        out.push_back({w.process, w.stream, w.publishes, true, {}});
    }
    return out;
}

constexpr int kRow = 44, kTop = 30, kBoxHeight = 28, kBoxWidth = 190, kColumn = 330, kLeft = 20;

} // namespace

std::string to_dot(Snapshot const& graph, bool framework) {
    std::string out = "digraph gridspace {\n  rankdir=LR;\n  node [fontname=\"sans-serif\"];\n";
    std::map<std::string, std::vector<Process const*>> hosts;
    for (Process const& p : graph.processes) {
        hosts[p.host].push_back(&p);
    }
    for (auto const& [host, processes] : hosts) {
        out += fmt::format("  subgraph {} {{\n    label={};\n", quoted("cluster_" + host), quoted(host));
        for (Process const* p : processes) {
            char const* colour = p->state == ProcessState::lost    ? "red"
                                 : p->state == ProcessState::alive ? "black"
                                                                   : "gray";
            out += fmt::format("    {} [shape=box, label={}, color={}];\n", quoted("p:" + p->name), quoted(p->name),
                               colour);
        }
        out += "  }\n";
    }
    std::set<std::string> middles;
    for (Arrow const& a : arrows_of(graph, framework)) {
        std::string const middle = quoted((a.wire ? "w:" : "t:") + a.middle), process = quoted("p:" + a.process);
        if (middles.insert(middle).second) {
            out +=
                fmt::format("  {} [shape={}, label={}];\n", middle, a.wire ? "hexagon" : "ellipse", quoted(a.middle));
        }
        out += fmt::format(
            "  {} -> {}{};\n", a.out ? process : middle, a.out ? middle : process,
            a.problems.empty() ? "" : fmt::format(" [color=red, tooltip={}]", quoted(join(a.problems, "; "))));
    }
    return out + "}\n";
}

std::string to_svg(Snapshot const& graph, bool framework) {
    std::vector<Arrow> const arrows = arrows_of(graph, framework);
    std::set<std::string> left, middle, right, wires;
    for (Arrow const& a : arrows) {
        (a.out ? left : right).insert(a.process);
        middle.insert(a.middle);
        if (a.wire) {
            wires.insert(a.middle);
        }
    }
    std::map<std::string, ProcessState> states;
    for (Process const& p : graph.processes) {
        states[p.name] = p.state;
        if (!left.contains(p.name) && !right.contains(p.name)) {
            left.insert(p.name); // it neither writes nor reads what is shown, and is there all the same
        }
    }
    std::size_t const rows = std::max({left.size(), middle.size(), right.size(), std::size_t{1}});
    int const height = kTop + static_cast<int>(rows) * kRow + 20, width = kLeft * 2 + kColumn * 2 + kBoxWidth;
    auto const y_of = [&](std::set<std::string> const& column, std::string const& name) {
        auto const index = static_cast<double>(std::distance(column.begin(), column.find(name)));
        double const step = static_cast<double>(rows) / static_cast<double>(column.size());
        return kTop + static_cast<int>((index + 0.5) * step * kRow);
    };
    std::string out = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
        width, height);
    for (Arrow const& a : arrows) {
        int const x1 = a.out ? kLeft + kBoxWidth : kLeft + kColumn + kBoxWidth,
                  x2 = a.out ? kLeft + kColumn : kLeft + 2 * kColumn;
        int const y1 = a.out ? y_of(left, a.process) : y_of(middle, a.middle),
                  y2 = a.out ? y_of(middle, a.middle) : y_of(right, a.process);
        out += fmt::format("<path d=\"M{} {} C{} {},{} {},{} {}\" fill=\"none\" stroke=\"{}\">{}</path>\n", x1, y1,
                           (x1 + x2) / 2, y1, (x1 + x2) / 2, y2, x2, y2, a.problems.empty() ? "#8a93a3" : "#c8213c",
                           a.problems.empty() ? "" : "<title>" + escape_markup(join(a.problems, "; ")) + "</title>");
    }
    auto const box = [&](std::set<std::string> const& column, int x, bool process) {
        for (std::string const& name : column) {
            int const y = y_of(column, name) - kBoxHeight / 2;
            auto const state = states.find(name);
            char const* stroke = !process ? (wires.contains(name) ? "#b7791f" : "#2457d6")
                                 : state == states.end() || state->second == ProcessState::alive ? "#1d2530"
                                 : state->second == ProcessState::lost                           ? "#c8213c"
                                                                                                 : "#b0b7c3";
            out += fmt::format(
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\" fill=\"#fff\" stroke=\"{}\"/>\n"
                "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"#1d2530\">{}</text>\n",
                x, y, kBoxWidth, kBoxHeight, process || wires.contains(name) ? 4 : 14, stroke, x + kBoxWidth / 2,
                y + 19, escape_markup(name));
        }
    };
    box(left, kLeft, true);
    box(middle, kLeft + kColumn, false);
    box(right, kLeft + 2 * kColumn, true);
    return out + "</svg>\n";
}

} // namespace gridspace::graph
