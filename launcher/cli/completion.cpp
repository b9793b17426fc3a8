// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/completion.hpp"

#include "common/text.hpp"

#include <fmt/format.h>

namespace gridspace::cli {
namespace {

std::string verb_list(std::vector<VerbOptions> const& verbs) {
    std::vector<std::string> names;
    for (VerbOptions const& verb : verbs) {
        names.push_back(verb.verb);
    }
    return join(names, " ");
}

std::string bash(std::vector<VerbOptions> const& verbs) {
    std::string cases;
    for (VerbOptions const& verb : verbs) {
        cases += fmt::format("        {}) options=\"{}\" ;;\n", verb.verb, join(verb.options, " "));
    }
    return fmt::format(R"(# bash completion for gridspace:  source <(gridspace completion bash)
_gridspace() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" options=""
    if [[ $COMP_CWORD -eq 1 ]]; then
        COMPREPLY=($(compgen -W "{}" -- "$word"))
        return
    fi
    case "${{COMP_WORDS[1]}}" in
{}    esac
    if [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$word"))
    else
        COMPREPLY=($(compgen -f -- "$word"))
    fi
}}
complete -o filenames -F _gridspace gridspace ./gridspace
)",
                       verb_list(verbs), cases);
}

std::string zsh(std::vector<VerbOptions> const& verbs) {
    std::string list, cases;
    for (VerbOptions const& verb : verbs) {
        list += fmt::format("        '{}:{}'\n", verb.verb, verb.description);
        cases += fmt::format("        {}) compadd -- {} ; _files ;;\n", verb.verb, join(verb.options, " "));
    }
    return fmt::format(R"(#compdef gridspace
# zsh completion for gridspace:  gridspace completion zsh > "${{fpath[1]}}/_gridspace"
_gridspace() {{
    local -a verbs=(
{}    )
    if (( CURRENT == 2 )); then
        _describe 'verb' verbs
        return
    fi
    case "$words[2]" in
{}    esac
}}
compdef _gridspace gridspace
)",
                       list, cases);
}

std::string fish(std::vector<VerbOptions> const& verbs) {
    std::string out = "# fish completion for gridspace:  gridspace completion fish | source\n";
    for (VerbOptions const& verb : verbs) {
        out +=
            fmt::format("complete -c gridspace -n __fish_use_subcommand -a {} -d '{}'\n", verb.verb, verb.description);
        for (std::string const& option : verb.options) {
            if (option.starts_with("--")) {
                out += fmt::format("complete -c gridspace -n '__fish_seen_subcommand_from {}' -l {}\n", verb.verb,
                                   option.substr(2));
            }
        }
    }
    return out;
}

} // namespace

std::string completion_script(std::string_view shell, std::vector<VerbOptions> const& verbs) {
    return shell == "bash" ? bash(verbs) : shell == "zsh" ? zsh(verbs) : shell == "fish" ? fish(verbs) : "";
}

} // namespace gridspace::cli
