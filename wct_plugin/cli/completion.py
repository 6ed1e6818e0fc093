"""``wct completion``: the script that completes what one types."""

import click


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
    click.echo(found(click.Group(), {}, "wct", "_WCT_COMPLETE").source())
    return 0
