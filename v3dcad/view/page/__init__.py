"""The page: a structure in one HTML file, which needs nothing else and nothing from outside.

Python makes arrays of a structure and packs them; the modules in JavaScript beside it unpack and
draw them in the browser.

    segments    the layers as arrays: walls, contours, struts, trees, cells
    motion      the toolpath as arrays
    content     all that a page holds: arrays and words
    first       what it shows when it is opened
    packing     arrays as text, small
    document    the file, put together
    serving     the page on 127.0.0.1, made again whenever a file changes

The browser's side, from `main.js` down:

    main.js       puts all the others together
    state.js      what is shown: the one object that controls write and drawing reads
    packed.js     arrays out of the text
    structure.js  the arrays as layers, walls, cells
    stage.js      canvas, camera and light; a frame is drawn when something changed
    slopes.js     how edges go on above and below their section
    strokes.js    many segments in one draw call: as lines, or as strips one layer high
    part.js       the part as a translucent skin
    fills.js      cells of a layer as coloured areas
    tree.js       the spanning tree of a layer
    toolpath.js   the nozzle's way up to a moment
    drawing.js    which of these each target draws
    clipping.js   the clipping plane
    cells.js      the cell at a point, its outline, area, neighbours
    pick.js       the cell under the pointer
    player.js     layers, or the print, one after the other
    panel.js      the controls
    facts.js      what is told of a cell
    keys.js       the keyboard
    theme.js      dark and light
    live.js       a served page that loads itself again
    three/        three.js, as it comes from npm, and its licence
"""
