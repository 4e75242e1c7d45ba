// SPDX-License-Identifier: BSD-3-Clause
package modslam.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.event.ActionEvent;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.awt.geom.AffineTransform;
import java.awt.geom.Path2D;
import java.awt.geom.Rectangle2D;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JFrame;
import javax.swing.JPanel;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;

/** A drawing in metres, x right and y up, that is fitted into its window. Subclasses take messages and draw; both hold the lock. */
abstract class MapPanel extends JPanel implements LCMSubscriber {
    private Rectangle2D box = new Rectangle2D.Double(-1, -1, 2, 2);
    private boolean empty = true;
    protected double pixel = 0.01;  // metres a pixel

    MapPanel() { setPreferredSize(new Dimension(460, 400)); setBackground(Color.WHITE); }

    abstract void take(String channel, LCMDataInputStream bytes) throws Exception;
    abstract void draw(Graphics2D g);

    /** Makes sure that a point is in view. */
    protected void see(double x, double y) {
        if (empty) box = new Rectangle2D.Double(x - 0.5, y - 0.5, 1, 1);
        empty = false;
        box.add(x, y);
    }
    protected void seeAnew() { empty = true; }
    protected BasicStroke width(double pixels) {
        return new BasicStroke((float) (pixels * pixel), BasicStroke.CAP_ROUND, BasicStroke.JOIN_ROUND);
    }
    protected void dot(Graphics2D g, double x, double y, double pixels) {
        double r = pixels * pixel / 2;
        g.fill(new Rectangle2D.Double(x - r, y - r, 2 * r, 2 * r));
    }
    protected static Path2D outline(double[] x, double[] y) {
        Path2D path = new Path2D.Double();
        for (int i = 0; i < x.length; i++) { if (i == 0) path.moveTo(x[i], y[i]); else path.lineTo(x[i], y[i]); }
        if (x.length > 0) path.closePath();
        return path;
    }
    /** Words at a point, upright again. */
    protected void say(Graphics2D g, String words, double x, double y) {
        AffineTransform before = g.getTransform();
        g.translate(x, y);
        g.scale(pixel, -pixel);
        g.drawString(words, -g.getFontMetrics().stringWidth(words) / 2, 4);
        g.setTransform(before);
    }

    @Override public synchronized void messageReceived(LCM lcm, String channel, LCMDataInputStream bytes) {
        try { take(channel, bytes); repaint(); } catch (Exception damaged) { /* spy's own table counts what cannot be decoded */ }
    }

    @Override protected synchronized void paintComponent(Graphics graphics) {
        super.paintComponent(graphics);
        Graphics2D g = (Graphics2D) graphics.create();
        g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
        double scale = 0.92 * Math.min(getWidth() / box.getWidth(), getHeight() / box.getHeight());
        g.translate(getWidth() / 2.0, getHeight() / 2.0);
        g.scale(scale, -scale);
        g.translate(-box.getCenterX(), -box.getCenterY());
        pixel = 1 / scale;
        draw(g);
        g.dispose();
    }

    /** Spy asks for an action without a channel too, only to learn its name. */
    static String nameOf(lcm.spy.ChannelData channel, String usual) { return channel == null ? usual : channel.name; }

    /** What a double click on a channel does: a window with a new panel that hears `channels` (a regular expression). */
    static Action window(String title, String channels, java.util.function.Supplier<MapPanel> make) {
        return new AbstractAction(title) {
            @Override public void actionPerformed(ActionEvent event) {
                MapPanel panel = make.get();
                JFrame frame = new JFrame(title);
                frame.add(panel);
                frame.pack();
                frame.addWindowListener(new WindowAdapter() {
                    @Override public void windowClosing(WindowEvent closing) { LCM.getSingleton().unsubscribe(channels, panel); }
                });
                LCM.getSingleton().subscribe(channels, panel);
                frame.setVisible(true);
            }
        };
    }
}
