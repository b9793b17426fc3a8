// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/scl_document.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::scl {
namespace {

constexpr char kNamespace[] = "http://www.iec.ch/61850/2003/SCL";
constexpr char kExpected[] = "expected an SCD, ICD, CID or IID file (IEC 61850-6)";

/// The parser's error in words.
std::string what_is_wrong(tinyxml2::XMLDocument const& xml) {
    using namespace tinyxml2;
    switch (xml.ErrorID()) {
    case XML_ERROR_MISMATCHED_ELEMENT:
        return "an element begins here and is closed by another name, or never";
    case XML_ERROR_PARSING_ATTRIBUTE:
        return "an attribute is not written NAME=\"VALUE\"";
    case XML_ERROR_PARSING_ELEMENT:
        return "an element has no name, or no >";
    case XML_ERROR_PARSING_COMMENT:
        return "a comment is not closed by -->";
    case XML_ERROR_PARSING_CDATA:
        return "a CDATA section is not closed by ]]>";
    case XML_ERROR_PARSING_DECLARATION:
        return "a declaration <?...?> is not closed, or does not stand first";
    case XML_ERROR_EMPTY_DOCUMENT:
        return "the file is empty";
    case XML_ELEMENT_DEPTH_EXCEEDED:
        return fmt::format("elements are nested more than {} deep", TINYXML2_MAX_ELEMENT_DEPTH);
    default:
        return xml.ErrorName();
    }
}

/// A document type may define entities that grow without end, or name files of this machine. SCL has none.
bool has_document_type(std::string_view text) {
    std::size_t const root = text.find("<SCL");
    return text.substr(0, root).find("<!DOCTYPE") != std::string_view::npos;
}

} // namespace

Result<Document> Document::parse(std::string const& text, std::string const& name) {
    if (text.size() > kLargestFile) {
        return fail(
            ExitCode::usage,
            fmt::format("{}: the file has {} MB; at most {} are read", name, text.size() >> 20U, kLargestFile >> 20U),
            "export the IEDs that are needed as CID files");
    }
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
        return fail(ExitCode::usage, fmt::format("{}: the file is UTF-16", name),
                    "convert it: iconv -f UTF-16 -t UTF-8");
    }
    Document out;
    out.places_ = std::make_unique<SourcePlaces>(name, text);
    if (has_document_type(text)) {
        std::size_t const at = text.find("<!DOCTYPE");
        auto const number =
            static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
        return fail(ExitCode::usage,
                    fmt::format("{}: the file has a document type (DOCTYPE): it is not read",
                                out.places_->line(number + 1).to_string()),
                    "SCL has none; entities of its own are a known way to exhaust a reader: take the lines out");
    }
    out.xml_ = std::make_unique<tinyxml2::XMLDocument>();
    if (out.xml_->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
        return fail(ExitCode::usage,
                    fmt::format("{}: not XML: {}", out.places_->line(std::max(1, out.xml_->ErrorLineNum())).to_string(),
                                what_is_wrong(*out.xml_)),
                    kExpected);
    }
    Element const* const root = out.xml_->RootElement();
    if (root == nullptr || local_name(*root) != "SCL") {
        return fail(ExitCode::usage,
                    fmt::format("{}: the root element is '{}', not SCL",
                                root == nullptr ? name : out.places_->of(*root).to_string(),
                                root == nullptr ? "nothing" : root->Name()),
                    kExpected);
    }
    return out;
}

void check_root(Document const& document, Findings& findings) {
    Element const& root = document.root();
    std::string_view const tag = root.Name();
    std::size_t const colon = tag.find(':');
    std::string const key = colon == std::string_view::npos ? "xmlns" : fmt::format("xmlns:{}", tag.substr(0, colon));
    std::string const found = attribute(root, key.c_str());
    if (found != kNamespace) {
        findings.add(Finding::Kind::doubtful, root, found.empty() ? nullptr : key.c_str(),
                     {"SCL",
                      found.empty() ? fmt::format("the root element has no {}: read as SCL all the same", key)
                                    : fmt::format("{} is '{}': read as SCL all the same", key, found),
                      fmt::format("{}=\"{}\"", key, kNamespace)});
    }
    if (child(root, "DataTypeTemplates") == nullptr && child(root, "IED") != nullptr) {
        findings.left_out(root, {"SCL", "there is no DataTypeTemplates: no data set can be resolved",
                                 "export the file with its types"});
    }
}

} // namespace gridspace::scl
