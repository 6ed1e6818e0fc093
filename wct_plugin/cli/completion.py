"""``wct completion``: the script that completes what one types."""

import click

from wct_plugin.io.standard_streams import writing_stdout

#: As click's own, but that bash, which takes ``--set a.b=c`` for three words, gets one word of it, and no blank after
#: what is to be typed on.
_BASH = """\
_wct_completion() {
    local IFS=$'\\n' response completion type value k words=() prefix=""
    for (( k = 0; k <= COMP_CWORD; k++ )); do
        if (( k > 0 )) && [[ ${COMP_WORDS[k]} == "=" || ${COMP_WORDS[k-1]} == "=" ]]; then
            words[-1]+=${COMP_WORDS[k]}
        else
            words+=("${COMP_WORDS[k]}")
        fi
    done
    [[ ${words[-1]} == *=* && $COMP_WORDBREAKS == *=* ]] && prefix="${words[-1]%%=*}="
    response=$(env COMP_WORDS="${words[*]}" COMP_CWORD=$(( ${#words[@]} - 1 )) _WCT_COMPLETE=bash_complete $1)
    for completion in $response; do
        IFS=',' read type value <<< "$completion"
        if [[ $type == 'dir' ]]; then
            COMPREPLY=()
            compopt -o dirnames
        elif [[ $type == 'file' ]]; then
            COMPREPLY=()
            compopt -o default
        elif [[ $type == 'plain' ]]; then
            COMPREPLY+=("${value#"$prefix"}")
            [[ $value == *[.=] ]] && compopt -o nospace
        fi
    done
    return 0
}
complete -o nosort -F _wct_completion wct
"""


@click.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> int:
    """Print the script that completes commands, options, filters and files in SHELL.

    For bash it goes to ~/.local/share/bash-completion/completions/wct, for zsh to a file _wct in a folder of $fpath,
    for fish to ~/.config/fish/completions/wct.fish.
    """
    from click.shell_completion import get_completion_class

    found = get_completion_class(shell)
    assert found is not None
    with writing_stdout():
        click.echo(_BASH if shell == "bash" else found(click.Group(), {}, "wct", "_WCT_COMPLETE").source())
    return 0
