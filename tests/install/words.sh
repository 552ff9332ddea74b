#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Completion offers the options that the commands have and the names that they take; the colours of editors know every
# statement, function and scheme.
#
#     words.sh BUILD SOURCE_ROOT
set -u
build=$(cd "$1" && pwd) || exit 99
root=$(cd "$2" && pwd) || exit 99
. "${0%/*}/../tap.sh"
. "$root/tests/install/stage.sh"

options_of() {
	"$1" --help | grep -o -e '--*[a-zA-Z][a-z0-9-]*' | grep -x -e '--[a-z][a-z0-9-]*' -e '-[a-zA-Z]' | sort -u
}

# ---- bash ----

cat >complete.bash <<'END'
# complete.bash FILE COMMAND WORDS ...: what is offered for the last word, one a line
source "$1"
shift
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_plgen
[ ${#COMPREPLY[@]} -eq 0 ] || printf '%s\n' "${COMPREPLY[@]}"
END
offers() {
	bash complete.bash "$prefix/share/bash-completion/completions/plgen" "$@" 2>>log | sort -u
}
if command -v bash >/dev/null 2>&1; then
	for command in plgen plrun; do
		: >log
		options_of $command >expected
		offers $command - >found
		diff expected found >>log && [ "$(wc -l <found)" -gt 15 ]
		result $? "bash: all $(wc -l <expected) options of $command"
	done
	plgen --help | sed -n 's/^  --scheme.*: //p' | tr ' ' '\n' | sort >expected
	offers plgen --scheme '' | diff expected - >log && [ "$(wc -l <expected)" -gt 10 ]
	result $? "bash: the $(wc -l <expected) schemes"
	offers plgen --plot c >found 2>log && [ "$(cat found)" = campbell ]
	result $? 'bash: a kind of picture'
	offers plgen --form k >found 2>log
	[ "$(cat found)" = kick-drift-kick ]
	result $? 'bash: a form'
	offers plgen --explain = j >found 2>log
	[ "$(cat found)" = json ]
	result $? 'bash: --explain=json'
	mkdir specs
	touch specs/a.spec specs/a.txt
	offers plgen specs/ >found 2>log
	[ "$(cat found)" = specs/a.spec ]
	result $? 'bash: specs alone'
else
	skip 'completion of bash' 'bash is not installed'
fi
if command -v zsh >/dev/null 2>&1; then
	zsh -n "$prefix/share/zsh/site-functions/_plgen" >log 2>&1
	result $? 'zsh: the completion can be read'
else
	skip 'completion of zsh' 'zsh is not installed'
fi

if command -v fish >/dev/null 2>&1; then
	# completes LINE: what is offered behind it, by the file that fish itself finds
	completes() {
		LINE=$1 STAGED=$prefix/share/fish/vendor_completions.d HOME=$PWD XDG_CONFIG_HOME=$PWD \
			XDG_DATA_HOME=$PWD fish -c 'set fish_complete_path $STAGED; complete -C $LINE' 2>>log |
			cut -f 1 | sort -u
	}
	for command in plgen plrun; do
		: >log
		options_of $command >expected
		completes "$command -" | sed '/=$/d' >found
		diff expected found >>log && [ "$(wc -l <found)" -gt 15 ]
		result $? "fish: all $(wc -l <expected) options of $command"
		plgen --help | sed -n 's/^  --scheme.*: //p' | tr ' ' '\n' | sort >expected
		completes "$command --scheme " | diff expected - >>log && [ "$(wc -l <expected)" -gt 10 ]
		result $? "fish: the $(wc -l <expected) schemes for $command"
	done
	: >log
	[ "$(completes 'plgen --plot c')" = campbell ] && [ "$(completes 'plgen --explain=j')" = --explain=json ]
	result $? 'fish: a kind of picture, --explain=json'
else
	skip 'completion of fish' 'fish is not installed'
fi

# ---- editors: the words of the sources ----

{
	sed -n '/^} statements\[\]/,/^};/p' "$root/gen/read/parse.c" | grep -o '{ "[a-z]*"' | tr -d '{ "'
	sed -n 's/^REAL_FUNCTION([A-Z]*, \([a-z]*\),.*/\1/p' "$root/gen/read/functions.def"
	sed -n '/function_names\[\]/,/^};/p' "$root/gen/read/names.c" | grep -o '"[a-z0-9]\{1,\}"' | tr -d '"'
	plgen --help | sed -n 's/^  --scheme.*: //p' | tr ' ' '\n'
} | sort -u >words
for file in vim/vimfiles/syntax/plgen.vim plgen/vscode/syntaxes/plgen.tmLanguage.json; do
	: >log
	while read -r word; do
		grep -q -w -e "$word" "$prefix/share/$file" || echo "$word" >>log
	done <words
	[ ! -s log ] && [ "$(wc -l <words)" -gt 50 ]
	result $? "$file: $(wc -l <words) words"
done
for file in package.json language-configuration.json syntaxes/plgen.tmLanguage.json; do
	python -m json.tool "$prefix/share/plgen/vscode/$file" >/dev/null 2>log
	result $? "vscode/$file is JSON"
done
if command -v vim >/dev/null 2>&1; then
	cat >look.vim <<'END'
set nocompatible
let &runtimepath = $FOLDER . ',' . &runtimepath
syntax on
edit look.spec
redir! > found
silent echo &filetype
silent echo synIDattr(synID(1, 1, 1), 'name')
silent echo synIDattr(synID(3, 1, 1), 'name')
silent echo synIDattr(synID(4, 11, 1), 'name')
silent echo synIDattr(synID(4, 20, 1), 'name')
redir END
qall!
END
	printf 'model look\ncoord x\nscheme exact\nx'"''"' + x = sin(t) # a load\nstep 0.1\n' >look.spec
	FOLDER=$prefix/share/vim/vimfiles timeout 20 vim -n -es -u look.vim >log 2>&1 </dev/null
	printf '%s\n' plgen plgenStatement plgenStatement plgenFunction plgenComment >expected
	grep -v '^$' found 2>>log | diff expected - >>log
	result $? 'vim: a spec is known by its first words, and coloured'
else
	skip 'vim: a spec is known' 'vim is not installed'
fi
tap_end
