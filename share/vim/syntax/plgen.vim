" SPDX-License-Identifier: MIT-0
" Vim syntax of plgen's specs
if exists("b:current_syntax")
  finish
endif
syntax case match

syntax match   plgenStatement "^\s*\(model\|param\|coord\|init\|let\|input\)\>"
syntax match   plgenStatement "^\s*\(output\|matrix\|mass\|spring\|damper\|force\)\>"
syntax match   plgenStatement "^\s*\(step\|scheme\|operator\|tunable\|tolerance\|substeps\|events\|modes\|use\)\>"
syntax match   plgenStatement "^\s*\(need\|budget\|regions\|energy\|dissipation\|constraint\)\>"
syntax match   plgenStatement "^\s*\(when\|stop\|friction\|range\|draw\|sensitivity\)\>"
syntax keyword plgenWord at hold first third fifth seventh between on ground as with
syntax keyword plgenWord within until for instructions without static restitution
syntax keyword plgenWord absolute of in
syntax keyword plgenConstant t pi
syntax match   plgenFunction "\<\(sin\|cos\|tan\|exp\|log\|sqrt\|abs\|sgn\|sinh\|cosh\|tanh\|asin\)\ze\s*("
syntax match   plgenFunction "\<\(acos\|atan\|atan2\|min\|max\|deadzone\|clip\|table\|peak\|friction\)\ze\s*("
syntax match   plgenFunction "\<\(sum\|cumsum\|dot\)\ze\s*("
syntax keyword plgenScheme exact pl etd1 etdrk2 etdrk4 nc2 nc3 dq4 bm3 taylor radau auto etdam4 etdam5 etdam6 etdcol
syntax match   plgenNumber "\<\d\+\(\.\d*\)\?\([eE][-+]\?\d\+\)\?"
syntax match   plgenNumber "\.\d\+\([eE][-+]\?\d\+\)\?"
syntax match   plgenPrime "\w\@1<=''\?"
syntax match   plgenPrime "\]\@1<=''\?"
syntax match   plgenOperator "[-+*/^=<>?:]"
syntax region  plgenString start=+"+ end=+"+ oneline
syntax match   plgenComment "#.*$" contains=plgenTodo
syntax keyword plgenTodo TODO FIXME contained

highlight default link plgenStatement Statement
highlight default link plgenWord      Keyword
highlight default link plgenConstant  Constant
highlight default link plgenFunction  Function
highlight default link plgenScheme    Type
highlight default link plgenNumber    Number
highlight default link plgenPrime     Special
highlight default link plgenOperator  Operator
highlight default link plgenString    String
highlight default link plgenComment   Comment
highlight default link plgenTodo      Todo

let b:current_syntax = "plgen"
