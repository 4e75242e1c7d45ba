// SPDX-License-Identifier: BSD-3-Clause
package modslam.spy;

import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.geom.Line2D;
import java.util.Map;
import java.util.TreeMap;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import modslam.door_list_t;
import modslam.door_t;
import modslam.object_list_t;
import modslam.object_t;
import modslam.room_list_t;
import modslam.room_t;
import modslam.wall_list_t;
import modslam.wall_t;

/** Rooms with names and areas, walls, doors and objects: the newest of each list, whichever of them was clicked. */
public class SemanticView implements SpyPlugin {
    @Override public boolean canHandle(long fingerprint) {
        return fingerprint == wall_list_t.LCM_FINGERPRINT || fingerprint == room_list_t.LCM_FINGERPRINT
            || fingerprint == door_list_t.LCM_FINGERPRINT || fingerprint == object_list_t.LCM_FINGERPRINT;
    }
    @Override public Action getAction(JDesktopPane desktop, ChannelData channel) {
        return MapPanel.window("Semantic map", "SEMANTIC_(WALLS|ROOMS|DOORS|OBJECTS)", Panel::new);
    }

    static class Panel extends MapPanel {
        private final Map<Integer, wall_list_t> walls = new TreeMap<>();  // by chunk
        private final Map<Integer, room_list_t> rooms = new TreeMap<>();
        private final Map<Integer, door_list_t> doors = new TreeMap<>();
        private final Map<Integer, object_list_t> objects = new TreeMap<>();

        private static <List> void put(Map<Integer, List> chunks, int chunk, int nchunks, List list) {
            chunks.keySet().removeIf(known -> known >= nchunks);
            chunks.put(chunk, list);
        }
        @Override void take(String channel, LCMDataInputStream bytes) throws Exception {
            switch (channel) {
                case "SEMANTIC_WALLS": { wall_list_t m = new wall_list_t(bytes); put(walls, m.chunk, m.nchunks, m); for (wall_t w : m.walls) { see(w.a[0], w.a[1]); see(w.b[0], w.b[1]); } break; }
                case "SEMANTIC_ROOMS": { room_list_t m = new room_list_t(bytes); put(rooms, m.chunk, m.nchunks, m); for (room_t r : m.rooms) for (int i = 0; i < r.npoints; i++) see(r.x[i], r.y[i]); break; }
                case "SEMANTIC_DOORS": { door_list_t m = new door_list_t(bytes); put(doors, m.chunk, m.nchunks, m); break; }
                default: { object_list_t m = new object_list_t(bytes); put(objects, m.chunk, m.nchunks, m); }
            }
        }
        @Override void draw(Graphics2D g) {
            for (room_list_t list : rooms.values()) for (room_t r : list.rooms) {
                g.setColor(Color.getHSBColor((float) (r.id * 0.381966 % 1), 0.25f, 0.95f));
                g.fill(outline(r.x, r.y));
            }
            g.setColor(new Color(0xa86a2c));
            g.setStroke(width(1.5));
            for (object_list_t list : objects.values()) for (object_t o : list.objects) g.draw(outline(o.x, o.y));
            g.setColor(new Color(0x1c2a33));
            g.setStroke(width(2));
            for (wall_list_t list : walls.values()) for (wall_t w : list.walls) g.draw(new Line2D.Double(w.a[0], w.a[1], w.b[0], w.b[1]));
            g.setStroke(width(4));
            for (door_list_t list : doors.values()) for (door_t d : list.doors) {
                g.setColor(new Color(d.state == door_t.CLOSED ? 0xb23a2e : 0x2c8a4b));
                g.draw(new Line2D.Double(d.a[0], d.a[1], d.b[0], d.b[1]));
            }
            g.setColor(new Color(0x233038));
            for (room_list_t list : rooms.values()) for (room_t r : list.rooms) nameOf(g, r);
        }
        private void nameOf(Graphics2D g, room_t r) {
            double x = 0, y = 0;
            for (int i = 0; i < r.npoints; i++) { x += r.x[i] / r.npoints; y += r.y[i] / r.npoints; }
            String name = r.name.isEmpty() ? (r.type == room_t.CORRIDOR ? "Corridor " : "Room ") + r.id : r.name;
            say(g, String.format("%.24s, %.1f m\u00b2", name, r.area_m2), x, y);
        }
    }
}
