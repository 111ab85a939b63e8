<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="tr" sourcelanguage="en">
  <context>
    <name>v3dcad</name>
    <message>
      <source>Starting v3dcad</source>
      <translation>v3dcad başlatılıyor</translation>
    </message>
    <message>
      <source>no temporary folder could be made ({why}); is the disk full?</source>
      <translation>geçici klasör oluşturulamadı ({why}); disk dolu mu?</translation>
    </message>
    <message>
      <source>v3dcad could not be started: {why}</source>
      <translation>v3dcad başlatılamadı: {why}</translation>
    </message>
    <message>
      <source>v3dcad ended in the middle of its work ({code}); it is started again</source>
      <translation>v3dcad çalışırken sona erdi ({code}); yeniden başlatılıyor</translation>
    </message>
    <message>
      <source>cancelled</source>
      <translation>iptal edildi</translation>
    </message>
    <message>
      <source>Voronoi fill</source>
      <translation>Voronoi dolgusu</translation>
    </message>
    <message>
      <source>Fill the selected solids, bodies or meshes with a foam that prints without support</source>
      <translation>Seçilen katıları, gövdeleri veya ağları desteksiz basılan bir köpükle doldur</translation>
    </message>
    <message>
      <source>Edit</source>
      <translation>Düzenle</translation>
    </message>
    <message>
      <source>Change the selected fill, with a preview of one layer</source>
      <translation>Seçilen dolguyu, bir katmanın önizlemesiyle değiştir</translation>
    </message>
    <message>
      <source>Show layer</source>
      <translation>Katmanı göster</translation>
    </message>
    <message>
      <source>Show one layer of the fill</source>
      <translation>Dolgunun bir katmanını göster</translation>
    </message>
    <message>
      <source>Show cell</source>
      <translation>Hücreyi göster</translation>
    </message>
    <message>
      <source>Show one cell of a layer</source>
      <translation>Bir katmanın bir hücresini göster</translation>
    </message>
    <message>
      <source>Show neighbours</source>
      <translation>Komşuları göster</translation>
    </message>
    <message>
      <source>Show a cell and its neighbours</source>
      <translation>Bir hücreyi ve komşularını göster</translation>
    </message>
    <message>
      <source>Show tree</source>
      <translation>Ağacı göster</translation>
    </message>
    <message>
      <source>Show the spanning tree of a layer</source>
      <translation>Bir katmanın kapsayan ağacını göster</translation>
    </message>
    <message>
      <source>Show cut</source>
      <translation>Kesiti göster</translation>
    </message>
    <message>
      <source>Show the fill cut upright</source>
      <translation>Dolguyu dikey kesilmiş göster</translation>
    </message>
    <message>
      <source>Show a layer</source>
      <translation>Bir katman göster</translation>
    </message>
    <message>
      <source>Create B-rep</source>
      <translation>B-rep oluştur</translation>
    </message>
    <message>
      <source>Make wires, faces, cells, thick walls or struts of the fill as a shape</source>
      <translation>Dolgunun tellerini, yüzlerini, hücrelerini, kalın duvarlarını veya çubuklarını şekil olarak oluştur</translation>
    </message>
    <message>
      <source>Export</source>
      <translation>Dışa aktar</translation>
    </message>
    <message>
      <source>Write G-code, .ont, STEP, 3MF or STL</source>
      <translation>G-code, .ont, STEP, 3MF veya STL yaz</translation>
    </message>
    <message>
      <source>Import .ont</source>
      <translation>.ont içe aktar</translation>
    </message>
    <message>
      <source>Open a foam from its .ont file</source>
      <translation>Bir köpüğü .ont dosyasından aç</translation>
    </message>
    <message>
      <source>Print or send…</source>
      <translation>Yazdır veya gönder…</translation>
    </message>
    <message>
      <source>Print the fill or a file over a cable, or send it to a print server</source>
      <translation>Dolguyu veya bir dosyayı kabloyla yazdır ya da bir baskı sunucusuna gönder</translation>
    </message>
    <message>
      <source>Set up…</source>
      <translation>Kur…</translation>
    </message>
    <message>
      <source>Make, repair or reset the environment that v3dcad runs in</source>
      <translation>v3dcad'in çalıştığı ortamı oluştur, onar veya sıfırla</translation>
    </message>
    <message>
      <source>Select a solid, a body or a closed mesh first.</source>
      <translation>Önce bir katı, gövde veya kapalı ağ seçin.</translation>
    </message>
    <message>
      <source>Select a Voronoi fill first.</source>
      <translation>Önce bir Voronoi dolgusu seçin.</translation>
    </message>
    <message>
      <source>The fill has no result yet: recompute it.</source>
      <translation>Dolgunun henüz sonucu yok: yeniden hesaplayın.</translation>
    </message>
    <message>
      <source>{count} edges: FreeCAD may be slow for minutes. Go on?</source>
      <translation>{count} kenar: FreeCAD dakikalarca yavaşlayabilir. Devam edilsin mi?</translation>
    </message>
    <message>
      <source>written</source>
      <translation>yazıldı</translation>
    </message>
    <message>
      <source>v3dcad is not set up yet: choose Voronoi 3D → Set up</source>
      <translation>v3dcad henüz kurulmadı: Voronoi 3D → Kur'u seçin</translation>
    </message>
    <message>
      <source>Looking for Python</source>
      <translation>Python aranıyor</translation>
    </message>
    <message>
      <source>Python cannot make environments. On Debian and Ubuntu: sudo apt install python3-venv</source>
      <translation>Python ortam oluşturamıyor. Debian ve Ubuntu'da: sudo apt install python3-venv</translation>
    </message>
    <message>
      <source>The package index cannot be reached. Is there a network? Then choose Repair.</source>
      <translation>Paket dizinine ulaşılamıyor. Ağ bağlantısı var mı? Sonra Onar'ı seçin.</translation>
    </message>
    <message>
      <source>The set-up was ended from outside; perhaps memory ran out. Choose Repair.</source>
      <translation>Kurulum dışarıdan sonlandırıldı; bellek yetmemiş olabilir. Onar'ı seçin.</translation>
    </message>
    <message>
      <source>The command ended without a word.</source>
      <translation>Komut bir şey söylemeden sona erdi.</translation>
    </message>
    <message>
      <source>Making the environment</source>
      <translation>Ortam oluşturuluyor</translation>
    </message>
    <message>
      <source>Loading and installing v3dcad</source>
      <translation>v3dcad indiriliyor ve kuruluyor</translation>
    </message>
    <message>
      <source>Compiling the engine</source>
      <translation>Motor derleniyor</translation>
    </message>
    <message>
      <source>{python} is not there: choose Voronoi 3D → Set up</source>
      <translation>{python} yerinde yok: Voronoi 3D → Kur'u seçin</translation>
    </message>
    <message>
      <source>The disk is full. Make room for {size} GB and choose Repair.</source>
      <translation>Disk dolu. {size} GB yer açın ve Onar'ı seçin.</translation>
    </message>
    <message>
      <source>v3dcad needs Python {oldest} to {newest}. Install one.</source>
      <translation>v3dcad için Python {oldest} ile {newest} arası gerekir. Birini kurun.</translation>
    </message>
    <message>
      <source>The folder may not be written to: {folder}</source>
      <translation>Klasöre yazma izni yok: {folder}</translation>
    </message>
    <message>
      <source>wires</source>
      <translation>teller</translation>
    </message>
    <message>
      <source>faces</source>
      <translation>yüzler</translation>
    </message>
    <message>
      <source>cells</source>
      <translation>hücreler</translation>
    </message>
    <message>
      <source>solid</source>
      <translation>katı</translation>
    </message>
    <message>
      <source>struts</source>
      <translation>çubuklar</translation>
    </message>
    <message>
      <source>Opening {name}</source>
      <translation>{name} açılıyor</translation>
    </message>
    <message>
      <source>Writing {name}</source>
      <translation>{name} yazılıyor</translation>
    </message>
    <message>
      <source>Making {form}</source>
      <translation>{form} oluşturuluyor</translation>
    </message>
    <message>
      <source>{name} (part)</source>
      <translation>{name} (parça)</translation>
    </message>
    <message>
      <source>Form</source>
      <translation>Biçim</translation>
    </message>
    <message>
      <source>G-code</source>
      <translation>G-code</translation>
    </message>
    <message>
      <source>generic-marlin, ender3v2 or a file of yours</source>
      <translation>generic-marlin, ender3v2 veya kendi dosyanız</translation>
    </message>
    <message>
      <source>Machine profile</source>
      <translation>Makine profili</translation>
    </message>
    <message>
      <source>What is changed here goes before the profile.</source>
      <translation>Burada değiştirilenler profilden önce gelir.</translation>
    </message>
    <message>
      <source>thick walls</source>
      <translation>kalın duvarlar</translation>
    </message>
    <message>
      <source>Layout of this object.</source>
      <translation>Bu nesnenin düzeni.</translation>
    </message>
    <message>
      <source>Source and settings that the result belongs to.</source>
      <translation>Sonucun ait olduğu kaynak ve ayarlar.</translation>
    </message>
    <message>
      <source>The lines, where they are too many for a shape.</source>
      <translation>Şekil için çok fazla olduklarında çizgiler.</translation>
    </message>
    <message>
      <source>Sites of the user's own, from an .ont file.</source>
      <translation>.ont dosyasından, kullanıcının kendi noktaları.</translation>
    </message>
    <message>
      <source>not computed yet</source>
      <translation>henüz hesaplanmadı</translation>
    </message>
    <message>
      <source>Machine profile that a density or a mass goes by; empty for the default.</source>
      <translation>Yoğunluğun veya kütlenin hesaplandığı makine profili; boşsa varsayılan.</translation>
    </message>
    <message>
      <source>What is filled.</source>
      <translation>Doldurulan parça.</translation>
    </message>
    <message>
      <source>stale: computing</source>
      <translation>eski: hesaplanıyor</translation>
    </message>
    <message>
      <source>Foam in {label}</source>
      <translation>{label} içinde köpük</translation>
    </message>
    <message>
      <source>FreeCAD could not read the shape that v3dcad wrote</source>
      <translation>FreeCAD, v3dcad'in yazdığı şekli okuyamadı</translation>
    </message>
    <message>
      <source>Compute Voronoi fill</source>
      <translation>Voronoi dolgusunu hesapla</translation>
    </message>
    <message>
      <source>Measuring {label}</source>
      <translation>{label} ölçülüyor</translation>
    </message>
    <message>
      <source>Filling {label}</source>
      <translation>{label} dolduruluyor</translation>
    </message>
    <message>
      <source>stale: recompute</source>
      <translation>eski: yeniden hesaplayın</translation>
    </message>
    <message>
      <source>failed: {why}</source>
      <translation>başarısız: {why}</translation>
    </message>
    <message>
      <source>Cell size, mm, as an expression of x, y, z.</source>
      <translation>Hücre boyutu, mm, x, y, z'nin bir ifadesi olarak.</translation>
    </message>
    <message>
      <source>Faces that cells are fine near to.</source>
      <translation>Yakınında hücrelerin küçük olduğu yüzler.</translation>
    </message>
    <message>
      <source>Distance from these faces where cells are coarse.</source>
      <translation>Bu yüzlerden, hücrelerin büyük olduğu uzaklık.</translation>
    </message>
    <message>
      <source>Result of the FEM workbench: cells are fine where its von Mises stress is high.</source>
      <translation>FEM tezgâhının bir sonucu: von Mises gerilmesinin yüksek olduğu yerde hücreler küçüktür.</translation>
    </message>
    <message>
      <source>Stress in MPa where cells are coarse.</source>
      <translation>Hücrelerin büyük olduğu gerilme, MPa.</translation>
    </message>
    <message>
      <source>Stress in MPa where cells are fine; 0 for the largest.</source>
      <translation>Hücrelerin küçük olduğu gerilme, MPa; en büyüğü için 0.</translation>
    </message>
    <message>
      <source>Size of fine cells.</source>
      <translation>Küçük hücrelerin boyutu.</translation>
    </message>
    <message>
      <source>Size of coarse cells.</source>
      <translation>Büyük hücrelerin boyutu.</translation>
    </message>
    <message>
      <source>Give a high stress that is above the low one.</source>
      <translation>Düşük gerilmenin üstünde bir yüksek gerilme verin.</translation>
    </message>
    <message>
      <source>Select faces in the view, then press “Take the selected faces”.</source>
      <translation>Görünümde yüzleri seçin, sonra “Seçili yüzleri al” düğmesine basın.</translation>
    </message>
    <message>
      <source>Choose a result of the FEM workbench.</source>
      <translation>FEM tezgâhının bir sonucunu seçin.</translation>
    </message>
    <message>
      <source>Write the cell size as an expression, such as 3 + 0.1 * z.</source>
      <translation>Hücre boyutunu bir ifade olarak yazın, örneğin 3 + 0.1 * z.</translation>
    </message>
    <message>
      <source>Give the distance where cells are coarse, more than 0.</source>
      <translation>Hücrelerin büyük olduğu uzaklığı verin, 0'dan büyük.</translation>
    </message>
    <message>
      <source>{label} has no von Mises stress.</source>
      <translation>{label} nesnesinde von Mises gerilmesi yok.</translation>
    </message>
    <message>
      <source>Expression</source>
      <translation>İfade</translation>
    </message>
    <message>
      <source>Faces</source>
      <translation>Yüzler</translation>
    </message>
    <message>
      <source>Coarse from</source>
      <translation>Büyük olduğu uzaklık</translation>
    </message>
    <message>
      <source>FEM result</source>
      <translation>FEM sonucu</translation>
    </message>
    <message>
      <source>Low stress</source>
      <translation>Düşük gerilme</translation>
    </message>
    <message>
      <source>High stress</source>
      <translation>Yüksek gerilme</translation>
    </message>
    <message>
      <source>Fine size</source>
      <translation>Küçük boyut</translation>
    </message>
    <message>
      <source>Coarse size</source>
      <translation>Büyük boyut</translation>
    </message>
    <message>
      <source>Take the selected faces</source>
      <translation>Seçili yüzleri al</translation>
    </message>
    <message>
      <source>Fill a part with a Voronoi foam that prints without support</source>
      <translation>Bir parçayı desteksiz basılan Voronoi köpüğüyle doldur</translation>
    </message>
    <message>
      <source>Voronoi 3D</source>
      <translation>Voronoi 3D</translation>
    </message>
    <message>
      <source>the environment that the set-up makes</source>
      <translation>kurulumun oluşturduğu ortam</translation>
    </message>
    <message>
      <source>Above it a fill is shown as lines: quicker, without edges that can be chosen.</source>
      <translation>Bunun üstünde dolgu çizgiler olarak gösterilir: daha hızlı, ama kenarlar seçilemez.</translation>
    </message>
    <message>
      <source>Set up, repair, reset…</source>
      <translation>Kur, onar, sıfırla…</translation>
    </message>
    <message>
      <source>Python with v3dcad</source>
      <translation>v3dcad olan Python</translation>
    </message>
    <message>
      <source>Edges up to which a fill is a shape</source>
      <translation>Dolgunun şekil olduğu en çok kenar sayısı</translation>
    </message>
    <message>
      <source>Preview</source>
      <translation>Önizleme</translation>
    </message>
    <message>
      <source>The print ended without a word.</source>
      <translation>Baskı bir şey söylemeden sona erdi.</translation>
    </message>
    <message>
      <source>Print or send</source>
      <translation>Yazdır veya gönder</translation>
    </message>
    <message>
      <source>A G-code file…</source>
      <translation>Bir G-code dosyası…</translation>
    </message>
    <message>
      <source>the file to print</source>
      <translation>yazdırılacak dosya</translation>
    </message>
    <message>
      <source>A printer or a port of the list; other ports can be typed.</source>
      <translation>Listeden bir yazıcı veya bağlantı noktası; başka bağlantı noktaları yazılabilir.</translation>
    </message>
    <message>
      <source>Look again</source>
      <translation>Yeniden ara</translation>
    </message>
    <message>
      <source>Start the print when the file is there</source>
      <translation>Dosya ulaşınca baskıyı başlat</translation>
    </message>
    <message>
      <source>For print servers; otherwise the file is only sent.</source>
      <translation>Baskı sunucuları için; yoksa dosya yalnızca gönderilir.</translation>
    </message>
    <message>
      <source>What</source>
      <translation>Ne</translation>
    </message>
    <message>
      <source>File</source>
      <translation>Dosya</translation>
    </message>
    <message>
      <source>Printer</source>
      <translation>Yazıcı</translation>
    </message>
    <message>
      <source>Nozzle</source>
      <translation>Nozul</translation>
    </message>
    <message>
      <source>Bed</source>
      <translation>Tabla</translation>
    </message>
    <message>
      <source>Pause</source>
      <translation>Duraklat</translation>
    </message>
    <message>
      <source>Resume</source>
      <translation>Sürdür</translation>
    </message>
    <message>
      <source>Cancel</source>
      <translation>İptal</translation>
    </message>
    <message>
      <source>STOP NOW</source>
      <translation>HEMEN DURDUR</translation>
    </message>
    <message>
      <source>choose…</source>
      <translation>seçin…</translation>
    </message>
    <message>
      <source>The file to print</source>
      <translation>Yazdırılacak dosya</translation>
    </message>
    <message>
      <source>Writing the G-code</source>
      <translation>G-code yazılıyor</translation>
    </message>
    <message>
      <source>printing</source>
      <translation>yazdırılıyor</translation>
    </message>
    <message>
      <source>not started</source>
      <translation>başlatılmadı</translation>
    </message>
    <message>
      <source>Choose a printer first.</source>
      <translation>Önce bir yazıcı seçin.</translation>
    </message>
    <message>
      <source>layer {layer} of {layers}</source>
      <translation>katman {layer} / {layers}</translation>
    </message>
    <message>
      <source>{hours} h {minutes} min left</source>
      <translation>{hours} sa {minutes} dk kaldı</translation>
    </message>
    <message>
      <source>sent to {printer} as {file}; {state}</source>
      <translation>{printer} yazıcısına {file} olarak gönderildi; {state}</translation>
    </message>
    <message>
      <source>G-code of {label}</source>
      <translation>{label} G-code'u</translation>
    </message>
    <message>
      <source>Print on {printer} now? It heats and moves.</source>
      <translation>{printer} üzerinde şimdi yazdırılsın mı? Isınır ve hareket eder.</translation>
    </message>
    <message>
      <source>Send to {printer}?</source>
      <translation>{printer} yazıcısına gönderilsin mi?</translation>
    </message>
    <message>
      <source>Connecting to {printer}</source>
      <translation>{printer} yazıcısına bağlanılıyor</translation>
    </message>
    <message>
      <source>The print cannot be reached: {why}. Use the printer's own switch.</source>
      <translation>Baskıya ulaşılamıyor: {why}. Yazıcının kendi anahtarını kullanın.</translation>
    </message>
    <message>
      <source>Too many prints are kept in {folder}</source>
      <translation>{folder} içinde çok fazla baskı tutuluyor</translation>
    </message>
    <message>
      <source>it was started by another FreeCAD</source>
      <translation>başka bir FreeCAD tarafından başlatıldı</translation>
    </message>
    <message>
      <source>expression</source>
      <translation>ifade</translation>
    </message>
    <message>
      <source>stress</source>
      <translation>gerilme</translation>
    </message>
    <message>
      <source>Whether the result belongs to the settings; if not, why.</source>
      <translation>Sonucun ayarlara ait olup olmadığı; değilse nedeni.</translation>
    </message>
    <message>
      <source>Number of layers.</source>
      <translation>Katman sayısı.</translation>
    </message>
    <message>
      <source>Number of edges of the shape, or of lines where they are too many for a shape.</source>
      <translation>Şeklin kenar sayısı; şekil için çok fazlaysa çizgi sayısı.</translation>
    </message>
    <message>
      <source>Number of cells.</source>
      <translation>Hücre sayısı.</translation>
    </message>
    <message>
      <source>Size of the cells as made.</source>
      <translation>Hücrelerin oluşan boyutu.</translation>
    </message>
    <message>
      <source>Tilt of the steepest wall from the vertical.</source>
      <translation>En eğik duvarın düşeyle açısı.</translation>
    </message>
    <message>
      <source>Length of the walls in all layers.</source>
      <translation>Tüm katmanlardaki duvar uzunluğu.</translation>
    </message>
    <message>
      <source>Mass as printed, in grams.</source>
      <translation>Basılan kütle, gram.</translation>
    </message>
    <message>
      <source>How every layer rests on the one below.</source>
      <translation>Her katmanın alttakine nasıl oturduğu.</translation>
    </message>
    <message>
      <source>What should be known of how the part was read.</source>
      <translation>Parçanın okunuşu hakkında bilinmesi gerekenler.</translation>
    </message>
    <message>
      <source>The check sum by which the structure is known; .ont files carry it.</source>
      <translation>Yapının tanındığı sağlama toplamı; .ont dosyaları taşır.</translation>
    </message>
    <message>
      <source>Where {name} comes from.</source>
      <translation>{name} değerinin nereden geldiği.</translation>
    </message>
    <message>
      <source>Set up Voronoi 3D</source>
      <translation>Voronoi 3D kurulumu</translation>
    </message>
    <message>
      <source>Python that has v3dcad</source>
      <translation>v3dcad bulunan Python</translation>
    </message>
    <message>
      <source>Voronoi 3D runs the engine v3dcad in a Python environment of its own. It loads about {load} GB from the package index and takes {disk} GB in
{folder}.
v3dcad itself comes from: {source}. Nothing is loaded before you press Set up.</source>
      <translation>Voronoi 3D, v3dcad motorunu kendi Python ortamında çalıştırır. Paket dizininden yaklaşık {load} GB indirir ve şurada {disk} GB yer kaplar:
{folder}.
v3dcad'in kaynağı: {source}. Kur'a basmadan hiçbir şey indirilmez.</translation>
    </message>
    <message>
      <source>v3dcad is set up.</source>
      <translation>v3dcad kuruldu.</translation>
    </message>
    <message>
      <source>Set up or repair</source>
      <translation>Kur veya onar</translation>
    </message>
    <message>
      <source>Use an existing Python…</source>
      <translation>Var olan bir Python kullan…</translation>
    </message>
    <message>
      <source>Reset</source>
      <translation>Sıfırla</translation>
    </message>
    <message>
      <source>Close</source>
      <translation>Kapat</translation>
    </message>
    <message>
      <source>{python} runs v3dcad.</source>
      <translation>{python} v3dcad'i çalıştırıyor.</translation>
    </message>
    <message>
      <source>{python} has no v3dcad: {why}</source>
      <translation>{python} içinde v3dcad yok: {why}</translation>
    </message>
    <message>
      <source>full</source>
      <translation>tümü</translation>
    </message>
    <message>
      <source>layer</source>
      <translation>katman</translation>
    </message>
    <message>
      <source>cell</source>
      <translation>hücre</translation>
    </message>
    <message>
      <source>neighbours</source>
      <translation>komşular</translation>
    </message>
    <message>
      <source>neighbour</source>
      <translation>komşu</translation>
    </message>
    <message>
      <source>tree</source>
      <translation>ağaç</translation>
    </message>
    <message>
      <source>cut</source>
      <translation>kesit</translation>
    </message>
    <message>
      <source>sizes</source>
      <translation>boyutlar</translation>
    </message>
    <message>
      <source>overhang</source>
      <translation>sarkma</translation>
    </message>
    <message>
      <source>toolpath</source>
      <translation>takım yolu</translation>
    </message>
    <message>
      <source>Show</source>
      <translation>Göster</translation>
    </message>
    <message>
      <source>Layer</source>
      <translation>Katman</translation>
    </message>
    <message>
      <source>Cell</source>
      <translation>Hücre</translation>
    </message>
    <message>
      <source>Neighbour</source>
      <translation>Komşu</translation>
    </message>
    <message>
      <source>Show {label}</source>
      <translation>{label} göster</translation>
    </message>
    <message>
      <source>The source was deleted: choose another one in the property Source.</source>
      <translation>Kaynak silindi: Source özelliğinde başka birini seçin.</translation>
    </message>
    <message>
      <source>the source could not be written ({why}); is the disk full?</source>
      <translation>kaynak yazılamadı ({why}); disk dolu mu?</translation>
    </message>
    <message>
      <source>{label} is an open mesh. Close it first: workbench Mesh, Meshes → Fill holes.</source>
      <translation>{label} açık bir ağ. Önce kapatın: Mesh tezgâhı, Ağlar → Delikleri doldur.</translation>
    </message>
    <message>
      <source>{label} has no shape.</source>
      <translation>{label} bir şekle sahip değil.</translation>
    </message>
    <message>
      <source>{label} encloses no volume: choose a solid, a body or a closed mesh. A sketch has to be padded first.</source>
      <translation>{label} bir hacim çevrelemiyor: bir katı, gövde veya kapalı ağ seçin. Eskiz önce katılaştırılmalı.</translation>
    </message>
    <message>
      <source>Edit Voronoi fill</source>
      <translation>Voronoi dolgusunu düzenle</translation>
    </message>
    <message>
      <source>Edit the fill</source>
      <translation>Dolguyu düzenle</translation>
    </message>
    <message>
      <source>Layer height</source>
      <translation>Katman yüksekliği</translation>
    </message>
    <message>
      <source>Chord tolerance</source>
      <translation>Kiriş toleransı</translation>
    </message>
    <message>
      <source>Base clearance</source>
      <translation>Taban payı</translation>
    </message>
    <message>
      <source>Method</source>
      <translation>Yöntem</translation>
    </message>
    <message>
      <source>Cell size</source>
      <translation>Hücre boyutu</translation>
    </message>
    <message>
      <source>Density</source>
      <translation>Yoğunluk</translation>
    </message>
    <message>
      <source>Mass</source>
      <translation>Kütle</translation>
    </message>
    <message>
      <source>Roof size</source>
      <translation>Çatı altı açıklığı</translation>
    </message>
    <message>
      <source>Stretch</source>
      <translation>Uzatma</translation>
    </message>
    <message>
      <source>Heights</source>
      <translation>Kesit yükseklikleri</translation>
    </message>
    <message>
      <source>Strict</source>
      <translation>Katı</translation>
    </message>
    <message>
      <source>Max overhang</source>
      <translation>En büyük sarkma</translation>
    </message>
    <message>
      <source>Random seed</source>
      <translation>Rastgele tohum</translation>
    </message>
    <message>
      <source>Sites</source>
      <translation>Noktalar</translation>
    </message>
    <message>
      <source>Offset</source>
      <translation>Ofset</translation>
    </message>
    <message>
      <source>Insertion</source>
      <translation>Ekleme</translation>
    </message>
    <message>
      <source>Interpolate</source>
      <translation>Ara değerle</translation>
    </message>
    <message>
      <source>Boundary tolerance</source>
      <translation>Sınır toleransı</translation>
    </message>
    <message>
      <source>Weight step</source>
      <translation>Ağırlık adımı</translation>
    </message>
    <message>
      <source>Thickness</source>
      <translation>Kalınlık</translation>
    </message>
    <message>
      <source>Skin</source>
      <translation>Kabuk</translation>
    </message>
    <message>
      <source>Diameter</source>
      <translation>Çap</translation>
    </message>
    <message>
      <source>Distance between two layers.</source>
      <translation>İki katman arasındaki uzaklık.</translation>
    </message>
    <message>
      <source>How far straight pieces of a contour may lie from a curved surface.</source>
      <translation>Bir konturun düz parçalarının eğri yüzeyden en çok ne kadar uzak olabileceği.</translation>
    </message>
    <message>
      <source>How far the part's base lies below the first layer; 0.1 in the thesis.</source>
      <translation>Parçanın tabanının ilk katmanın ne kadar altında olduğu; tezde 0.1.</translation>
    </message>
    <message>
      <source>What the part is filled with: a foam of cells in space, or the thesis's own structure.</source>
      <translation>Parçanın neyle doldurulduğu: uzayda hücrelerden köpük veya tezin kendi yapısı.</translation>
    </message>
    <message>
      <source>foam</source>
      <translation>köpük</translation>
    </message>
    <message>
      <source>thesis</source>
      <translation>tez</translation>
    </message>
    <message>
      <source>Size of the cells: a horizontal section has one for each square of this side; auto takes 40 in the base rectangle, from 3 to 15 mm. An expression of x, y, z makes it differ from place to place.</source>
      <translation>Hücre boyutu: yatay kesitte bu kenarlı her kareye bir hücre düşer; auto, taban dikdörtgeninde 40 hücre alır, 3 ile 15 mm arasında. x, y, z ile yazılan bir ifade, boyutu yerden yere değiştirir.</translation>
    </message>
    <message>
      <source>auto</source>
      <translation>otomatik</translation>
    </message>
    <message>
      <source>Share of the part's volume that is printed: walls, perimeters and skins as the print settings make them. Cells get the size that it takes. 0.15 or 15%.</source>
      <translation>Parça hacminin basılan payı: baskı ayarlarının yaptığı duvarlar, çevreler ve dolu katmanlarla. Hücreler bunun gerektirdiği boyutu alır. 0.15 veya 15%.</translation>
    </message>
    <message>
      <source>off</source>
      <translation>kapalı</translation>
    </message>
    <message>
      <source>What the printed part weighs, brim and skirt left out. Cells get the size that it takes.</source>
      <translation>Basılan parçanın kütlesi, kenarlık ve etek hariç. Hücreler bunun gerektirdiği boyutu alır.</translation>
    </message>
    <message>
      <source>Largest span of a skin over cells: under roofs no cell is wider. The .ont file then lists all sites.</source>
      <translation>Hücreler üzerindeki bir kabuğun en büyük açıklığı: çatıların altında hiçbir hücre daha geniş olmaz. .ont dosyası o zaman tüm noktaları listeler.</translation>
    </message>
    <message>
      <source>How many times as tall as wide cells are, about; auto takes the least that --max-overhang allows. columns makes upright walls.</source>
      <translation>Hücrelerin yüksekliğinin genişliğine yaklaşık oranı; auto, --max-overhang'in izin verdiği en küçüğü alır. columns dik duvarlar yapar.</translation>
    </message>
    <message>
      <source>columns</source>
      <translation>sütunlar</translation>
    </message>
    <message>
      <source>Where a layer's section is taken: in the middle of the bead that fills it, or at its bottom, as the thesis does.</source>
      <translation>Bir katmanın kesitinin alındığı yer: onu dolduran şeridin ortasında ya da tezdeki gibi altında.</translation>
    </message>
    <message>
      <source>middle</source>
      <translation>orta</translation>
    </message>
    <message>
      <source>bottom</source>
      <translation>alt</translation>
    </message>
    <message>
      <source>Refuse a cell size that changes more steeply than cells can follow, instead of making them smaller there.</source>
      <translation>Hücrelerin izleyemeyeceği kadar dik değişen bir hücre boyutunu, orada hücreleri küçültmek yerine reddet.</translation>
    </message>
    <message>
      <source>Largest tilt of a wall from the vertical, 10 to 80; 90 allows any.</source>
      <translation>Bir duvarın düşeyden en büyük eğimi, 10 ile 80; 90 her eğime izin verir.</translation>
    </message>
    <message>
      <source>Another number gives other cells of the same kind.</source>
      <translation>Başka bir sayı aynı türden başka hücreler verir.</translation>
    </message>
    <message>
      <source>Number of sites, scattered evenly in the base rectangle.</source>
      <translation>Taban dikdörtgenine eşit dağıtılan nokta sayısı.</translation>
    </message>
    <message>
      <source>Weight that a growing cell gains in each layer; auto takes the largest that --max-overhang allows (at 90, what 45 would).</source>
      <translation>Büyüyen bir hücrenin her katmanda kazandığı ağırlık; auto, --max-overhang'in izin verdiği en büyüğü alır (90'da, 45'inkini).</translation>
    </message>
    <message>
      <source>New cells come in where cells have become too large.</source>
      <translation>Hücreler fazla büyüdüğünde yeni hücreler eklenir.</translation>
    </message>
    <message>
      <source>Compute the first and last layer only and loft between them, cell by cell.</source>
      <translation>Yalnızca ilk ve son katmanı hesapla, aralarını hücre hücre doldur.</translation>
    </message>
    <message>
      <source>How close to the contour a corner counts as on it.</source>
      <translation>Bir köşenin kontur üzerinde sayılması için en büyük uzaklık.</translation>
    </message>
    <message>
      <source>Steps in which an inserted cell's weight is lowered; 0 for the offset.</source>
      <translation>Eklenen bir hücrenin ağırlığının azaltıldığı adım; ofset için 0.</translation>
    </message>
    <message>
      <source>beads</source>
      <translation>şeritler</translation>
    </message>
    <message>
      <source>beams</source>
      <translation>kirişler</translation>
    </message>
    <message>
      <source>project</source>
      <translation>dilimleyici projesi</translation>
    </message>
    <message>
      <source>walls</source>
      <translation>duvarlar</translation>
    </message>
    <message>
      <source>Machine</source>
      <translation>Makine</translation>
    </message>
    <message>
      <source>Nozzle diameter</source>
      <translation>Nozul çapı</translation>
    </message>
    <message>
      <source>Bead width</source>
      <translation>Şerit genişliği</translation>
    </message>
    <message>
      <source>Bead shape</source>
      <translation>Şerit biçimi</translation>
    </message>
    <message>
      <source>Flow</source>
      <translation>Akış</translation>
    </message>
    <message>
      <source>First layer height</source>
      <translation>İlk katman yüksekliği</translation>
    </message>
    <message>
      <source>First layer speed</source>
      <translation>İlk katman hızı</translation>
    </message>
    <message>
      <source>First layer flow</source>
      <translation>İlk katman akışı</translation>
    </message>
    <message>
      <source>Minimum edge</source>
      <translation>En kısa kenar</translation>
    </message>
    <message>
      <source>Contour</source>
      <translation>Kontur</translation>
    </message>
    <message>
      <source>Perimeters</source>
      <translation>Çevreler</translation>
    </message>
    <message>
      <source>Perimeter order</source>
      <translation>Çevre sırası</translation>
    </message>
    <message>
      <source>Wall beads</source>
      <translation>Duvar başına şerit</translation>
    </message>
    <message>
      <source>Seam</source>
      <translation>Dikiş</translation>
    </message>
    <message>
      <source>Bottom layers</source>
      <translation>Alt katmanlar</translation>
    </message>
    <message>
      <source>Top layers</source>
      <translation>Üst katmanlar</translation>
    </message>
    <message>
      <source>Skin span</source>
      <translation>Dolu katman açıklığı</translation>
    </message>
    <message>
      <source>Open</source>
      <translation>Açık</translation>
    </message>
    <message>
      <source>Skirt loops</source>
      <translation>Etek turları</translation>
    </message>
    <message>
      <source>Skirt distance</source>
      <translation>Etek uzaklığı</translation>
    </message>
    <message>
      <source>Brim width</source>
      <translation>Kenarlık genişliği</translation>
    </message>
    <message>
      <source>Prime line</source>
      <translation>Başlangıç çizgisi</translation>
    </message>
    <message>
      <source>Print speed</source>
      <translation>Baskı hızı</translation>
    </message>
    <message>
      <source>Perimeter speed</source>
      <translation>Çevre hızı</translation>
    </message>
    <message>
      <source>Solid speed</source>
      <translation>Dolu katman hızı</translation>
    </message>
    <message>
      <source>Bridge speed</source>
      <translation>Köprü hızı</translation>
    </message>
    <message>
      <source>Bridge flow</source>
      <translation>Köprü akışı</translation>
    </message>
    <message>
      <source>Travel speed</source>
      <translation>Boşta hız</translation>
    </message>
    <message>
      <source>Minimum layer time</source>
      <translation>En kısa katman süresi</translation>
    </message>
    <message>
      <source>Slowest speed</source>
      <translation>En düşük hız</translation>
    </message>
    <message>
      <source>Most speed</source>
      <translation>En büyük hız</translation>
    </message>
    <message>
      <source>Most flow</source>
      <translation>En büyük akış</translation>
    </message>
    <message>
      <source>Z speed</source>
      <translation>Z hızı</translation>
    </message>
    <message>
      <source>Acceleration</source>
      <translation>İvme</translation>
    </message>
    <message>
      <source>Perimeter acceleration</source>
      <translation>Çevre ivmesi</translation>
    </message>
    <message>
      <source>Solid acceleration</source>
      <translation>Dolu katman ivmesi</translation>
    </message>
    <message>
      <source>Bridge acceleration</source>
      <translation>Köprü ivmesi</translation>
    </message>
    <message>
      <source>Travel acceleration</source>
      <translation>Boş hareket ivmesi</translation>
    </message>
    <message>
      <source>Corner speed</source>
      <translation>Köşe hızı</translation>
    </message>
    <message>
      <source>Filament diameter</source>
      <translation>Filament çapı</translation>
    </message>
    <message>
      <source>Filament density</source>
      <translation>Filament yoğunluğu</translation>
    </message>
    <message>
      <source>Pressure advance</source>
      <translation>Basınç avansı</translation>
    </message>
    <message>
      <source>Retraction</source>
      <translation>Geri çekme</translation>
    </message>
    <message>
      <source>Retraction speed</source>
      <translation>Geri çekme hızı</translation>
    </message>
    <message>
      <source>Retraction travel</source>
      <translation>Geri çekmesiz yol</translation>
    </message>
    <message>
      <source>Retraction by</source>
      <translation>Geri çeken</translation>
    </message>
    <message>
      <source>Z hop</source>
      <translation>Z sıçraması</translation>
    </message>
    <message>
      <source>Wipe</source>
      <translation>Silme</translation>
    </message>
    <message>
      <source>Nozzle temperature</source>
      <translation>Nozul sıcaklığı</translation>
    </message>
    <message>
      <source>Bed temperature</source>
      <translation>Tabla sıcaklığı</translation>
    </message>
    <message>
      <source>First layer hotter</source>
      <translation>İlk katman daha sıcak</translation>
    </message>
    <message>
      <source>First layer bed hotter</source>
      <translation>İlk katmanda tabla daha sıcak</translation>
    </message>
    <message>
      <source>Fan</source>
      <translation>Fan</translation>
    </message>
    <message>
      <source>Bridge fan</source>
      <translation>Köprüde fan</translation>
    </message>
    <message>
      <source>Fan from layer</source>
      <translation>Fanın başladığı katman</translation>
    </message>
    <message>
      <source>Fan full layer</source>
      <translation>Fanın tam açıldığı katman</translation>
    </message>
    <message>
      <source>Fail over</source>
      <translation>En uzun askı</translation>
    </message>
    <message>
      <source>Flavour</source>
      <translation>Yazılım türü</translation>
    </message>
    <message>
      <source>Extrusion</source>
      <translation>Ekstrüzyon</translation>
    </message>
    <message>
      <source>Arcs</source>
      <translation>Yaylar</translation>
    </message>
    <message>
      <source>Build height</source>
      <translation>Baskı yüksekliği</translation>
    </message>
    <message>
      <source>Bed origin</source>
      <translation>Tabla sıfırı</translation>
    </message>
    <message>
      <source>Start gcode</source>
      <translation>Başlangıç G-code'u</translation>
    </message>
    <message>
      <source>End gcode</source>
      <translation>Bitiş G-code'u</translation>
    </message>
    <message>
      <source>pausing</source>
      <translation>duraklatılıyor</translation>
    </message>
    <message>
      <source>paused</source>
      <translation>duraklatıldı</translation>
    </message>
    <message>
      <source>resuming</source>
      <translation>sürdürülüyor</translation>
    </message>
    <message>
      <source>cancelling</source>
      <translation>iptal ediliyor</translation>
    </message>
    <message>
      <source>finishing</source>
      <translation>bitiriliyor</translation>
    </message>
    <message>
      <source>ended</source>
      <translation>sona erdi</translation>
    </message>
    <message>
      <source>finished</source>
      <translation>bitti</translation>
    </message>
    <message>
      <source>printer halted</source>
      <translation>yazıcı durdu</translation>
    </message>
    <message>
      <source>connection lost</source>
      <translation>bağlantı koptu</translation>
    </message>
    <message>
      <source>no answer</source>
      <translation>yanıt yok</translation>
    </message>
    <message>
      <source>file changed</source>
      <translation>dosya değişti</translation>
    </message>
    <message>
      <source>given</source>
      <translation>verilen</translation>
    </message>
  </context>
</TS>
