// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/data_card.hpp"

#include "common/text.hpp"
#include "common/version.hpp"

#include <fmt/format.h>
#include <set>

namespace gridspace::dataset {
namespace {

constexpr std::string_view kColumns = R"(
## Files
| file | what |
|---|---|
| `runs.csv` | a row for each run: scenario, grid, seed, kinds of attack, and the part of the data that it is for |
| `attacks.csv` | a row for each attack of each run: what, where, when, how many labels, how many frames of the captures |
| `captures.csv` | a row for each vantage point of each run, and its counts |
| `runs/RUN/VANTAGE.pcapng` | the frames that were seen there; each altered one has the comment `attack NAME` |
| `runs/RUN/VANTAGE.frames.csv` | the label of each frame |
| `runs/RUN/VANTAGE.samples.csv` | features of each sample of sampled values, with its label |
| `runs/RUN/VANTAGE.messages.csv` | features of each GOOSE message, with its label |
| `runs/RUN/labels.csv` | the ground truth as the attacker said it |
| `runs/RUN/scenario.yaml`, `network.yaml` | what was run; the attacks' schedule is in it |
| `manifest.json` | SHA-256 of every file |

A vantage point is a link (all its ports together: what its receivers hear) or a point inside a cable, in front of a man in the middle.
Its name is in `captures.csv`; in names of files everything but letters, digits and `_` is a dot.

## Columns
In all tables with a row for each frame, sample or message:

| column | meaning |
|---|---|
| `frame` | number of the frame in the capture of the vantage point, from 1, as Wireshark counts |
| `time_s` | when it was seen, seconds of simulated time since the start of the run |
| `port` | where it was seen |
| `source` | MAC address of the sender |
| `stream` | name of the stream in the scenario; of others what the frame says |
| `altered` | 1: forged, or altered on its way. The label |
| `attack` | by which attack of `attacks.csv` |

`frames.csv` has also `protocol` (`smv`, `goose`, `other`). In `samples.csv`:

| column | meaning |
|---|---|
| `sample` | number of the sample since the start of the run: its second times the rate, plus smpCnt |
| `smp_cnt`, `smp_synch`, `simulated` | as the frame says |
| `gap_us` | microseconds since the sample before of this stream, whoever sent it, by the stamps of the capture |
| `count_step` | difference of `sample` to the one before: 1 in order, 0 a second one of the same number |
| `ia_a`, `ib_a`, `ic_a` | instantaneous currents, primary amperes |
| `sum_a` | their sum, A |
| `kink_a_a`, `kink_b_a`, `kink_c_a` | x[n] - 2 cos(w) x[n-1] + x[n-2] of each phase, A; 0 of a sinusoid of the grid's nominal frequency. The two before are those that came first |
| `peak_a` | largest size of a phase current in the nominal cycle before, A |
| `altered_phases` | which of `abc` |

In `messages.csv`:

| column | meaning |
|---|---|
| `st_num`, `sq_num`, `live_ms`, `conf_rev`, `simulated`, `entries` | as the message says; entries: members of the data set |
| `st_step`, `sq_step` | difference to the message before |
| `gap_ms` | milliseconds since the message before, by the stamps of the capture |
| `age_ms` | milliseconds from the time of the state, as the message says it, to when it was seen |
| `data_changed` | 1: the data are not those of the message before |

An empty cell: there is none (nothing came before; no three currents). In `labels.csv`: `target` (stream or topic), `index` (number of the
sample; of messages and commands their number since the start of the attack), `phase`, `attack`, `kind`, `true_value`, `sent_value` (A, or 0 and 1).
Messages that an attacker dropped have a label and no frame.

## Parts
`split_by_grid` and `split_by_attack` of `runs.csv` say `train`, `validation` or `test`. By grid: all runs of a network are in one part.
By attack: all runs with a kind of attack are in one part, and kinds that were seen together in a run too; runs without any attack are spread over the parts.
A kind of attack in the test part was never seen in training. With one group everything is `train`; with two there is no `validation`.

## How the labels were made
Sampled values: the attacker publishes each phase-sample that it altered, with the true and the sent value; a captured sample is altered when it
is labelled and nearer to what was sent than to what is true. GOOSE: a message is forged when it came from the port of the attacker of its stream within the attack's time,
and altered when it left a cable with an attacker in it as none had come into it.

)";

} // namespace

std::string data_card(DataSet const& data, DataSetOptions const& options) {
    std::set<std::string> grids, kinds, commits, seeds;
    double duration_s = 0;
    std::uint64_t frames = 0, altered = 0;
    for (DataSetRun const& run : data.runs) {
        grids.insert(run.source.grid);
        commits.insert(fmt::format("{} ({})", run.source.version, run.source.commit));
        seeds.insert(std::to_string(run.source.seed));
        duration_s += run.source.simulated_s;
        for (std::string const& kind : run.source.kinds()) {
            kinds.insert(kind);
        }
        for (ExportedRun::Vantage const& v : run.exported.vantages) {
            frames += v.frames;
            altered += v.altered;
        }
    }
    auto const list = [](std::set<std::string> const& names) { return join({names.begin(), names.end()}, ", "); };
    std::string out = fmt::format(
        "# Attacks on a substation's process bus: labelled frames and features\n\n"
        "Sampled values (IEC 61850-9-2) and GOOSE (IEC 61850-8-1) of simulated substations, healthy and attacked, with "
        "a "
        "label for each frame.\nThe grid, the devices and the attackers were simulated by Gridspace; no frame comes "
        "from a "
        "real substation.\n\n"
        "| | |\n|---|---|\n"
        "| runs | {} |\n| simulated time | {} s |\n| frames, altered | {}, {} |\n| grids | {} |\n| kinds of attack | "
        "{} |\n"
        "| seeds of the runs | {} |\n| made by gridspace | {} |\n| exported by gridspace | {} ({}) |\n"
        "| seed of the parts | {} |\n| licence | [CC-BY-4.0](https://creativecommons.org/licenses/by/4.0/) |\n",
        data.runs.size(), shortest(duration_s), frames, altered, list(grids), kinds.empty() ? "none" : list(kinds),
        list(seeds), list(commits), version().version, version().commit, options.seed);
    out += kColumns;
    out += fmt::format("## To make it again\nThe runs: `gridspace run` on their scenarios with their seeds; a study of "
                       "`gridspace sweep` repeats all of its runs. Then:\n```\n{}\n```\n"
                       "The same runs and seed give the same octets.\n",
                       options.command);
    return out;
}

} // namespace gridspace::dataset
