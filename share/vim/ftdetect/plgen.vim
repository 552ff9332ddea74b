" SPDX-License-Identifier: MIT-0
" .spec is also what RPM packages are described in: those are left alone.
autocmd BufNewFile,BufRead *.spec
    \ if join(getline(1, 50), "\n") =~# '\(^\|\n\)\s*model\s\+\h\w*\s*\(#\|\n\|$\)' | set filetype=plgen | endif
