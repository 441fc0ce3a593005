"""The 3-D scene: what is seen, and the self-contained page that shows it.

`scene` says what is to be seen, `building` makes it of a model and measurements; `links`, `bodies`
and `shapes` are the arm's looks, `frame` what stands on the page at one moment, `mechanism` and
`payload` what the page is given, `static` and `cloud` the pages as files.
"""
