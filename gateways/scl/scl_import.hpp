// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "common/result.hpp"
#include "gateways/scl/scl_document.hpp"

#include <string>
#include <vector>

namespace gridspace::scl {

struct ImportOptions {
    std::vector<std::string> ieds; ///< empty: all
    double nominal_hz{50};         ///< for rates that are given per period
};

/// Where a member of a data set comes from, in the words of its FCDA.
struct MemberOrigin {
    std::string name; ///< its key in `data_set`
    std::string ld_inst, prefix, ln_class, ln_inst, object, attribute;
    double scale{0}, offset{0}; ///< sVC of its data object: value = i * scale + offset; scale 0: not said
};

/// A control block that became a stream.
struct ControlBlock {
    std::string stream; ///< its key in `streams`
    std::string ied, ld_inst, ld_name, block;
    bool goose{true};
    config::SourceMark where;
    std::vector<MemberOrigin> members;
};

/// One that could not be used.
struct RefusedBlock {
    std::string ied, ld_inst, block;
    config::SourceMark where;
};

struct Import {
    config::Node streams;              ///< a `streams:` map, by "<IED>_<control block>"
    std::vector<std::string> notes;    ///< what was left out or assumed, with the line
    std::vector<Finding> findings;     ///< the same, with column and remedy
    std::size_t findings_dropped{0};   ///< beyond kMostFindings
    std::vector<ControlBlock> blocks;  ///< in the order of `streams`
    std::vector<RefusedBlock> refused; ///< left out; `findings` say why
};

/// Where an imported stream goes: its MAC address, or its group over UDP.
[[nodiscard]] std::string destination_of(config::Node const& stream);

/// Reads the GOOSE and SMV control blocks of an SCL file (SCD, ICD, CID, IID; any edition, any prefix). Liberal: a
/// control block that cannot be read is left out and noted. Fails when the file is no SCL or the IED is not in it.
[[nodiscard]] Result<Import> import_streams(std::string const& text, std::string const& name,
                                            ImportOptions const& options);
/// The same of a document that was parsed; `findings` are added to.
[[nodiscard]] Result<Import> import_streams(Document const& document, ImportOptions const& options, Findings& findings);
/// Puts what was found into `out`.
void keep_findings(Findings const& findings, Import& out);

} // namespace gridspace::scl
