#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Each text of --help, of a refusal and of a report comes from the catalog of translations: in a language that puts every
text in «», no word is outside, but names.

Usage: translated.py SOURCE_FOLDER PROGRAM...
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(sys.argv[1])
PROGRAMS = [pathlib.Path(program) for program in sys.argv[2:]]
# Of GLib and GStreamer, whose catalogs these are not.
OTHERS = ['Help Options:', 'Show help options', 'Show all help options', 'Show GStreamer Options', '[OPTION...]']

folder = tempfile.TemporaryDirectory()
place = pathlib.Path(folder.name, 'xx/LC_MESSAGES')
place.mkdir(parents=True)


def command(*words, **more):
    return subprocess.run(words, check=True, capture_output=True, text=True, **more).stdout


def make_language():
    options = re.findall("'(--[^']+)'", (SOURCE / 'po/meson.build').read_text())
    texts = command('xgettext', *options, '--language=C++', '--files-from=po/POTFILES', '--output=-', cwd=SOURCE)
    own = command('msgfilter', '--keep-header', 'sed', '-z', r's/^\(\n*\)\(.*[^\n]\)/\1«\2»/', input=command('msgen', '-', input=texts))
    command('msgfmt', f'--output-file={place}/visuotactile.mo', '-', input=own)


def said(program, *arguments):
    environment = {**os.environ, 'LC_ALL': 'C.UTF-8', 'LANGUAGE': 'xx', 'VISUOTACTILE_LOCALE': folder.name, 'HOME': folder.name}
    run = subprocess.run([program, *arguments], capture_output=True, text=True, env=environment)
    return run.stdout + run.stderr


def outside(text):
    for other in OTHERS:
        text = text.replace(other, '')
    while (shorter := re.sub('«[^«»]*»', '', text)) != text:
        text = shorter
    assert '«' not in text and '»' not in text, text
    return text


def expect_translated(program, names, *arguments):
    text = said(program, *arguments)
    assert '«' in text, (program.name, arguments, text)
    rest = [word for word in re.split(r'[\s,;:()\[\]\'"]+', outside(text))
            if re.search('[a-z]{2}', word) and not word.startswith('-') and word not in names]
    assert not rest, f'{program.name} {" ".join(arguments)}: these words are not from the catalog: {rest}'


make_language()
for program in PROGRAMS:
    commands = re.findall(r'(?m)^  ([a-z]+) +«', said(program, '--help').split('\n\n')[1]) if program.name != 'visuotactile' else []
    keys = re.findall(r'(?m)^  ([a-z]+): «', said(program, 'set', '--help')) if 'set' in commands else []
    names = {program.name, *commands, *keys, 'screen|sound', 'jellyfin|emby|plex', 'driver=NAME', 'device=ID', 'r0c2', 'r1c1'}
    expect_translated(program, names, '--help')
    for name in commands:
        expect_translated(program, names, name, '--help')
    expect_translated(program, {*names, 'nothing'}, *(['nothing'] if commands else ['--motor=1', '--port=x']))
print(f'{len(PROGRAMS)} programs: each text is from the catalog')
