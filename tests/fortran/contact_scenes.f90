!> Decks of small contact scenes that tests run: boxes of solid elements and a round tool.
module contact_scenes
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type
   use lopin_clock, only : clock_type
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_model, only : model_type
   use lopin_build_model, only : new_model
   use lopin_recorder, only : recorder_holder_type
   use lopin_recorder_last, only : last_recorder_type
   use lopin_run_analysis, only : run_analysis
   use lopin_report, only : summary_type, frame_type
   implicit none
   private
   public :: scene_names, scene_text, box, second_order_box, run_text

   character(len=1), parameter :: nl = achar(10)
   !> roller, crown: two bodies, driven and floating; indent, punch: a tool, driven and floating.
   character(len=6), parameter :: scene_names(4) = ['roller', 'crown ', 'indent', 'punch ']

contains

   !> A deck. `behaviour` are the lines of *SURFACE BEHAVIOR, `extra` whole cards of the model part.
   function scene_text(name, behaviour, extra, fine) result(text)
      character(len=*), intent(in) :: name, behaviour, extra
      integer, intent(in) :: fine              !! divisions per unit of the coarsest mesh
      character(len=:), allocatable :: text, mesh, hold, load, master

      load = ''
      select case (name)
      case ('roller')
         mesh = box('UP', 0, [0.0_wp, 0.0_wp], [8.0_wp, 4.0_wp], [8, 4]*fine, 20.0_wp) &
            & //box('LOW', 100000, [0.0_wp, -4.0_wp], [10.0_wp, 0.0_wp], [11, 4]*fine, 0.0_wp)
         hold = 'UPX0, 1'//nl//'LOWX0, 1'//nl//'LOWBOT, 2'//nl
         load = '*BOUNDARY'//nl//'UPTOP, 2, 2, -0.2'//nl
         master = 'LOWF'
      case ('crown')
         mesh = box('UP', 0, 0.0_wp*[1, 1, 1], 1.0_wp*[3, 3, 2], [4, 4, 2]*fine, 20.0_wp) &
            & //box('LOW', 100000, 1.0_wp*[0, 0, -2], 1.0_wp*[4, 4, 0], [5, 5, 2]*fine, 0.0_wp)
         hold = 'UPX0, 1'//nl//'UPY0, 2'//nl//'LOWX0, 1'//nl//'LOWY0, 2'//nl//'LOWBOT, 3'//nl
         load = '*DLOAD'//nl//'UPTOPE, P2, 500.'//nl
         master = 'LOWF'
      case default
         mesh = '*NODE, NSET=REF'//nl//'900000, 0., 5.'//nl//box('UP', 0, [0.0_wp, -4.0_wp], &
            & [8.0_wp, 0.0_wp], &
            & [10, 5]*fine, 0.0_wp)//'*SURFACE, NAME=TOOL, TYPE=SEGMENTS'//nl//'START, 8., 4.'//nl &
            & //'CIRCL, 0., 0., 0., 10.'//nl//'CIRCL, -8., 4., 0., 10.'//nl &
            & //'*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=REF'//nl
         hold = 'UPX0, 1'//nl//'UPBOT, 2'//nl//'REF, 1'//nl//'REF, 6'//nl
         if (name == 'indent') load = '*BOUNDARY'//nl//'REF, 2, 2, -0.2'//nl
         if (name == 'punch') load = '*CLOAD'//nl//'REF, 2, -9000.'//nl
         master = 'TOOL'
      end select
      text = mesh//'*MATERIAL, NAME=STEEL'//nl//'*ELASTIC'//nl//'200000., 0.3'//nl &
         & //'*SOLID SECTION, ELSET=UP, MATERIAL=STEEL'//nl
      if (master == 'LOWF') text = text//'*MATERIAL, NAME=SOFT'//nl//'*ELASTIC'//nl &
         & //'70000., 0.3'//nl &
         & //'*SOLID SECTION, ELSET=LOW, MATERIAL=SOFT'//nl
      text = text//'*SURFACE INTERACTION, NAME=TOUCH'//nl//'*SURFACE BEHAVIOR'//behaviour//nl &
         & //'*CONTACT PAIR, INTERACTION=TOUCH'//nl//'UPF, '//master//nl//extra//'*BOUNDARY'//nl &
         & //hold &
         & //'*STEP'//nl//'*STATIC, DIRECT'//nl//'0.5, 1.'//nl//load//'*END STEP'//nl
   end function scene_text

   !> A structured box with its sets and its contact surface: the bottom, crowned by x^2/(2 radius),
   !> or, if there is no radius, the top.
   function box(name, offset, low, high, n, radius) result(text)
      character(len=*), intent(in) :: name
      integer, intent(in) :: offset
      real(wp), intent(in) :: low(:), high(:)
      integer, intent(in) :: n(:)
      real(wp), intent(in) :: radius           !! 0: flat
      character(len=:), allocatable :: text
      character(len=120) :: line
      real(wp) :: x(size(n)), share
      integer :: m(3), i(3), d, node, element, corner(8)
      character(len=:), allocatable :: x0, y0, bottom, top, face_elements, top_elements, label

      d = size(n)
      m = 0
      m(:d) = n
      x0 = ''
      y0 = ''
      bottom = ''
      top = ''
      face_elements = ''
      top_elements = ''
      text = '*NODE'//nl
      do node = 0, product(m(:d) + 1) - 1
         i = place_of(node)
         x = low + (high - low)*i(:d)/n
         if (radius > 0.0_wp) then
            share = (high(d) - x(d))/(high(d) - low(d))
            x(d) = x(d) + share*sum(x(:d - 1)**2)/(2.0_wp*radius)
         end if
         write (line, '(i0,3(", ",f0.12))') offset + node + 1, x
         text = text//trim(line)//nl
         if (i(1) == 0) x0 = x0//word(offset + node + 1)
         if (d == 3 .and. i(2) == 0) y0 = y0//word(offset + node + 1)
         if (i(d) == 0) bottom = bottom//word(offset + node + 1)
         if (i(d) == n(d)) top = top//word(offset + node + 1)
      end do
      text = text//'*ELEMENT, ELSET='//name//', TYPE='//trim(merge('CPE4', 'C3D8', d == 2))//nl
      do element = 0, product(n) - 1
         i(1) = mod(element, n(1))
         i(2) = mod(element/n(1), n(2))
         i(3) = element/(n(1)*n(2))
         corner(:4) = offset + [at(i), at(i + [1, 0, 0]), at(i + [1, 1, 0]), at(i + [0, 1, 0])]
         corner(5:) = offset + [at(i + [0, 0, 1]), at(i + [1, 0, 1]), &
            & at(i + [1, 1, 1]), at(i + [0, 1, 1])]
         write (line, '(i0,8(", ",i0))') offset + element + 1, corner(:merge(4, 8, d == 2))
         text = text//trim(line)//nl
         label = word(offset + element + 1)
         if (i(d) == merge(0, n(d) - 1, radius > 0.0_wp)) face_elements = face_elements//label
         if (i(d) == n(d) - 1) top_elements = top_elements//label
      end do
      text = text//'*NSET, NSET='//name//'X0'//nl//x0//'*NSET, NSET='//name//'BOT'//nl//bottom &
         & //'*NSET, NSET='//name//'TOP'//nl//top//'*ELSET, ELSET='//name//'FE'//nl//face_elements &
         & //'*ELSET, ELSET='//name//'TOPE'//nl//top_elements//'*SURFACE, NAME='//name//'F'//nl &
         & //name//'FE, '
      if (d == 3) text = text//merge('S1', 'S2', radius > 0.0_wp)//nl//'*NSET, NSET='//name &
         & //'Y0'//nl//y0
      if (d == 2) text = text//merge('S1', 'S3', radius > 0.0_wp)//nl

   contains

      function place_of(number) result(i)
         integer, intent(in) :: number
         integer :: i(3)
         i(1) = mod(number, m(1) + 1)
         i(2) = mod(number/(m(1) + 1), m(2) + 1)
         i(3) = number/((m(1) + 1)*(m(2) + 1))
      end function place_of

      integer function at(i)
         integer, intent(in) :: i(3)
         at = 1 + i(1) + (m(1) + 1)*(i(2) + (m(2) + 1)*i(3))
      end function at
   end function box

   !> A box of CPE8 or C3D20: its surface F on top, its nodes BOT.
   function second_order_box(name, low, high, n) result(text)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: low(:), high(:)
      integer, intent(in) :: n(:)
      character(len=:), allocatable :: text
      integer, parameter :: corner(3, 8) = reshape([0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, &
         & 0, 0, 2, 2, 0, 2, 2, 2, 2, 0, 2, 2], [3, 8]), &
         & ends(2, 12) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 5, 6, 6, 7, 7, 8, 8, 5, 1, 5, 2, 6, &
         & 3, 7, 4, 8], [2, 12])
      character(len=200) :: line
      character(len=:), allocatable :: bottom, top
      integer :: m(3), i(3), d, k, e

      d = size(n)
      m = 1
      m(:d) = 2*n + 1
      bottom = ''
      top = ''
      text = '*NODE'//nl
      do k = 0, product(m) - 1
         i = [mod(k, m(1)), mod(k/m(1), m(2)), k/(m(1)*m(2))]
         if (count(mod(i, 2) == 1) > 1) cycle
         write (line, '(i0,3(", ",f0.12))') k + 1, low + (high - low)*i(:d)/(2.0_wp*n)
         text = text//trim(line)//nl
         if (i(d) == 0) bottom = bottom//word(k + 1)
      end do
      text = text//'*ELEMENT, ELSET='//name//', TYPE='//trim(merge('CPE8  ', 'C3D20 ', d == 2))//nl
      do e = 0, product(n) - 1
         i = 2*[mod(e, n(1)), mod(e/n(1), n(2)), e/(n(1)*n(2))]
         write (line, '(i0,20(", ",i0))') e + 1, &
            & [(at(i + corner(:, k)), k=1, merge(4, 8, d == 2))], &
            & [(at(i + (corner(:, ends(1, k)) + corner(:, ends(2, k)))/2), &
            & k=1, merge(4, 12, d == 2))]
         k = merge(len_trim(line), index(line(:100), ',', back=.true.), d == 2)
         text = text//line(:k)//nl
         if (d == 3) text = text//trim(line(k + 1:))//nl
         if (i(d) == m(d) - 3) top = top//word(e + 1)
      end do
      text = text//'*NSET, NSET='//name//'BOT'//nl//bottom//'*ELSET, ELSET='//name//'FE'//nl//top &
         & //'*SURFACE, NAME='//name//'F'//nl//name//'FE, '//merge('S3', 'S2', d == 2)//nl

   contains

      integer function at(i)
         integer, intent(in) :: i(3)
         at = 1 + i(1) + m(1)*(i(2) + m(2)*i(3))
      end function at
   end function second_order_box

   function word(number) result(text)
      integer, intent(in) :: number
      character(len=:), allocatable :: text
      character(len=14) :: digits
      write (digits, '(i0,",")') number
      text = trim(digits)//nl
   end function word

   !> Run a deck and keep its last increment.
   subroutine run_text(text, frame, summary, error)
      character(len=*), intent(in) :: text
      type(frame_type), intent(out) :: frame
      type(summary_type), intent(out) :: summary
      type(error_type), allocatable, intent(out) :: error
      type(recorder_holder_type) :: recorders(1)
      type(deck_type) :: deck
      type(model_type) :: model
      type(log_type) :: log
      type(clock_type) :: clock

      call read_deck_text(deck, text, 'scene.inp', '', log, error)
      if (.not. allocated(error)) call new_model(model, deck, error)
      if (allocated(error)) return
      allocate (last_recorder_type :: recorders(1)%recorder)
      call run_analysis(model, recorders, clock, summary, log, error)
      select type (last => recorders(1)%recorder)
      type is (last_recorder_type)
         frame = last%frame
      end select
   end subroutine run_text
end module contact_scenes
