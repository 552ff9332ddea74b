# SPDX-License-Identifier: GPL-3.0-or-later
# braces.py FILE.c ...: each body of an if, an else or a loop that has no braces (MISRA C 2012, rule 15.6), by name of
# the file, and how many there are with braces.
import re
import sys


def skip_brackets(text, at):
    depth = 0
    while True:
        depth += (text[at] == '(') - (text[at] == ')')
        at += 1
        if depth == 0:
            return at


def look(text):
    """bodies with braces, and the text around those without"""
    text = re.sub(r'/\*.*?\*/', ' ', text, flags=re.S)
    text = re.sub(r'"(\\.|[^"\\\n])*"', '""', text)
    text = re.sub(r'^[ \t]*#(.*\\\n)*.*$', '', text, flags=re.M)
    good, bad = 0, []
    for word in re.finditer(r'\b(if|for|while|switch|else|do)\b', text):
        at = word.end()
        if word.group() not in ('else', 'do'):
            at = skip_brackets(text, text.index('(', at))
        rest = text[at:].lstrip()
        ends_do = word.group() == 'while' and rest.startswith(';') and text[:word.start()].rstrip().endswith('}')
        if rest.startswith('{'):
            good += 1
        elif not ends_do and not (word.group() == 'else' and re.match(r'if\b', rest)):
            bad.append(' '.join(text[word.start():at + 60].split()))
    return good, bad


whole = 0
failed = False
for name in sys.argv[1:]:
    with open(name) as file:
        good, bad = look(file.read())
    whole += good
    for text in bad:
        print('%s: %s' % (name, text))
        failed = True
print('%d bodies with braces' % whole)
sys.exit(failed)
