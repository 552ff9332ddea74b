#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# unresolved.sh PLGEN UNSEEN SOURCE FIRST COUNT: that many random models with what coefficients at one time do not show,
# by adaptive series, by both and by collocation, beside extrapolation in long double with short steps (unresolved.c);
# FIRST from 1000000 on: those that are given. What is wrong has to be told; no more than one in twenty may be.
unresolved=$(realpath "$2")
root=$3
first=$4
models=$5
. "${0%/*}/../plgen.sh"
cat >drive.c <<'END'
#include "m.h"
#include <math.h>
#include <stdio.h>
int main(int count, char **argument)
{
	m s;
	int k, i;
	double y[M_STATES];
	m_init(&s);
	for (k = 0; k < 12; k++) {
		for (i = (int)lround(1.0 / M_H); i > 0; i--)
			m_step(&s);
		if (k == 0)
			printf("%s", argument[count - 1]);
		m_get(&s, y);
		for (i = 0; i < M_STATES; i++)
			printf(" %.17g", y[i]);
	}
	printf(" %d\n", m_status(&s));
	return 0;
}
END

# rows SEED: lines for the judge
rows() {
	"$unresolved" spec "$1" >m.spec
	for scheme in taylor auto radau; do
		"$plgen" --scheme "$scheme" m.spec -o m.c >>log 2>&1 &&
			$run_cc -I. -I"$root/runtime" -o drive drive.c m.c "$archive" -lm >>log 2>&1 &&
			./drive "$scheme" 2>>log | awk '{ status = $NF; $NF = ""; sub(" ", " " status " "); print }'
	done
}

told=0
for seed in $(seeds "$first" "$models"); do
	: >log
	rows "$seed" >lines
	"$unresolved" judge "$seed" <lines >verdicts
	cat verdicts m.spec >>log
	for scheme in taylor auto radau; do
		grep -q "^0 $scheme " verdicts
		result $? "model $seed by $scheme"
	done
	told=$((told + $(grep -c 'told [1-9]' verdicts)))
done
echo "$told of $((3 * models)) have told" >log
[ $((20 * told)) -le $((3 * models)) ]
result $? 'few of them have only told'
tap_end
