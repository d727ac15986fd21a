!> `job.dat`: the tables of *NODE PRINT, *EL PRINT and *CONTACT PRINT, in CalculiX's layout.
!>
!> Read like CalculiX's, with these differences: elements of the plane have their own integration
!> points and not those of an expanded brick; forces of an axisymmetric scene are on the full
!> circumference; CDIS is the signed gap of every slave node that faces a master, open ones too.
module lopin_recorder_dat
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   use lopin_mesh, only : set_type
   use lopin_model, only : model_type, output_type, output_of
   use lopin_report, only : frame_type
   use lopin_recorder, only : recorder_type, wants_type
   use lopin_atomic_file, only : log_file_type
   use lopin_text_buffer, only : text_buffer_type
   use lopin_element_points, only : point_tables_type, new_point_tables, element_measures
   use lopin_recorder_table, only : is_due, frame_asks, has_variable
   use lopin_recorder_dat_contact, only : put_contact
   implicit none
   private
   public :: dat_recorder_type, new_dat_recorder

   type, extends(recorder_type) :: dat_recorder_type
      private
      character(len=:), allocatable :: path
      type(log_file_type) :: log
      type(text_buffer_type) :: text
      type(point_tables_type) :: points
   contains
      procedure :: begin
      procedure :: commit
      procedure :: increment
      procedure :: close => close_file
      procedure :: keep
      procedure :: wants
   end type dat_recorder_type

contains

   subroutine new_dat_recorder(self, path)
      type(dat_recorder_type), intent(out) :: self
      character(len=*), intent(in) :: path
      self%path = path
   end subroutine new_dat_recorder

   subroutine begin(self, model, error)
      class(dat_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call new_point_tables(self%points, model)
      call self%log%open(self%path, '', error, self%resumes)
   end subroutine begin

   subroutine commit(self, error)
      class(dat_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call self%log%commit(error)
   end subroutine commit

   subroutine increment(self, model, frame, error)
      class(dat_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call self%text%clear()
      associate (output => model%step(frame%step)%output)
         do i = 1, size(output)
            if (.not. is_due(output(i)%frequency, frame)) cycle
            if (output(i)%kind == output_of%node_print) call put_nodes(self%text, model, &
               & output(i), frame)
            if (output(i)%kind == output_of%element_print) then
               call put_elements(self%text, self%points, model, output(i), frame)
            end if
            if (output(i)%kind == output_of%contact_print) call put_contact(self%text, model, &
               & output(i), frame)
         end do
      end associate
      if (self%text%n > 0) call self%log%append(self%text%text(:self%text%n), error)
   end subroutine increment

   subroutine keep(self, stream, error)
      class(dat_recorder_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error

      call self%log%keep(stream, error)
   end subroutine keep

   subroutine close_file(self, error)
      class(dat_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call self%log%close(error)
   end subroutine close_file

   function wants(self, model, frame) result(what)
      class(dat_recorder_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(wants_type) :: what

      associate (unused => self)
         what%stress = frame_asks(model, frame, output_of%element_print, ['S   ', 'ELSE'])
         what%strain = frame_asks(model, frame, output_of%element_print, ['E   ', 'ELSE'])
      end associate
   end function wants

   subroutine put_nodes(text, model, output, frame)
      type(text_buffer_type), intent(inout) :: text
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      type(frame_type), intent(in) :: frame
      integer, allocatable :: item(:)
      character(len=:), allocatable :: set

      call members(model%mesh%nset, output%set, model%mesh%node_label, 'NALL', item, set)
      if (has_variable(output%variable, ['U       '])) then
         call put_nodal(text, 'displacements (vx,vy,vz)', set, model, item, output%global, &
            & frame%u(:3, :), frame)
      end if
      if (.not. has_variable(output%variable, ['RF      '])) return
      if (.not. output%totals_only) call put_nodal(text, 'forces (fx,fy,fz)', set, &
         & model, item, output%global, frame%rf(:3, :), frame)
      if (output%totals .or. output%totals_only) then
         call put_total(text, 'total force (fx,fy,fz)', set, sum(frame%rf(:3, item), dim=2), frame)
      end if
   end subroutine put_nodes

   subroutine put_elements(text, points, model, output, frame)
      type(text_buffer_type), intent(inout) :: text
      type(point_tables_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      type(frame_type), intent(in) :: frame
      integer, allocatable :: item(:)
      character(len=:), allocatable :: set
      integer :: k

      call members(model%mesh%elset, output%set, model%mesh%element_label, 'EALL', item, set)
      if (has_variable(output%variable, ['S       '])) then
         call put_points(text, 'stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz)', set, item, &
            & 1.0_wp, frame%stress)
      end if
      ! CalculiX prints the components of the strain tensor, half the engineering shears.
      if (has_variable(output%variable, ['E       '])) then
         call put_points(text, 'strains (elem, integ.pnt.,exx,eyy,ezz,exy,exz,eyz)', set, item, &
            & 0.5_wp, frame%strain)
      end if
      if (has_variable(output%variable, ['PEEQ    '])) call put_points(text, &
         & 'equivalent plastic strain (elem, integ.pnt.,pe)', set, item, 1.0_wp, &
         & frame%plastic_strain)
      if (has_variable(output%variable, ['DAMAGE  ']) .and. allocated(frame%damage)) then
         do k = 1, size(frame%damage)
            call put_points(text, 'damage '//frame%damage(k)%name//' and its mean (elem, '// &
               & 'integ.pnt.,d,mean)', set, item, 1.0_wp, frame%damage(k)%value)
         end do
      end if
      if (has_variable(output%variable, ['ELSE    ', 'EVOL    '])) call put_measures(text, points, &
         & model, output, frame)

   contains

      subroutine put_points(text, title, set, item, shear, values)
         type(text_buffer_type), intent(inout) :: text
         character(len=*), intent(in) :: title, set
         integer, intent(in) :: item(:)
         real(wp), intent(in) :: shear                      !! factor on the shears
         real(wp), allocatable, intent(in) :: values(:, :)  !! (6, 2 or 1, npoint)
         integer :: i, k, j, e

         if (.not. allocated(values)) return
         call put_title(text, title, set, frame)
         do i = 1, size(item)
            e = item(i)
            do k = 1, frame%first_point(e + 1) - frame%first_point(e)
               call text%put_integer(model%mesh%element_label(e), 10)
               call text%put_integer(k, 4)
               do j = 1, size(values, 1)
                  call text%put(' ')
                  call text%put_exponential(merge(1.0_wp, shear, j <= 3) &
                     & *values(j, frame%first_point(e) - 1 + points%order(k, &
                     & model%mesh%etype(e))), 6)
               end do
               call text%put_line()
            end do
         end do
      end subroutine put_points
   end subroutine put_elements

   !> Energy and volume of elements, and their sums.
   subroutine put_measures(text, points, model, output, frame)
      type(text_buffer_type), intent(inout) :: text
      type(point_tables_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      type(frame_type), intent(in) :: frame
      integer, allocatable :: item(:)
      character(len=:), allocatable :: set
      real(wp), allocatable :: measure(:, :)      !! (2, nelement) energy, volume

      call members(model%mesh%elset, output%set, model%mesh%element_label, 'EALL', item, set)
      call element_measures(points, model, item, frame, measure)
      if (has_variable(output%variable, ['ELSE    '])) call put_measure('internal energy', &
         & 'energy', measure(1:1, :))
      if (has_variable(output%variable, ['EVOL    '])) call put_measure('volume', 'volume', &
         & measure(2:2, :))

   contains

      subroutine put_measure(title, column, values)
         character(len=*), intent(in) :: title, column
         real(wp), intent(in) :: values(:, :)

         if (.not. output%totals_only) call put_table(text, title//' (element, '//column//')', &
            & set, model%mesh%element_label, item, values, frame)
         if (output%totals .or. output%totals_only) call put_total(text, 'total '//title, set, &
            & sum(values(:, item), dim=2), frame)
      end subroutine put_measure
   end subroutine put_measures

   !> Items of a set in the order of their labels, as CalculiX prints them; set 0 is everything.
   subroutine members(sets, set, label, everything, item, name)
      type(set_type), intent(in) :: sets(:)
      integer, intent(in) :: set
      integer, intent(in) :: label(:)
      character(len=*), intent(in) :: everything
      integer, allocatable, intent(out) :: item(:)
      character(len=:), allocatable, intent(out) :: name
      integer :: i

      if (set == 0) then
         name = everything
         item = [(i, i=1, size(label))]
      else
         name = sets(set)%name
         item = sets(set)%member
      end if
      call sort_by_label(item, label)
   end subroutine members

   !> Shell sort: sets are nearly always sorted already.
   pure subroutine sort_by_label(item, label)
      integer, intent(inout) :: item(:)
      integer, intent(in) :: label(:)
      integer :: gap, i, j, held

      gap = size(item)/2
      do while (gap > 0)
         do i = gap + 1, size(item)
            held = item(i)
            j = i
            do while (j > gap)
               if (label(item(j - gap)) <= label(held)) exit
               item(j) = item(j - gap)
               j = j - gap
            end do
            item(j) = held
         end do
         gap = gap/2
      end do
   end subroutine sort_by_label

   !> Lines in the axes of a node end in L, as in CalculiX.
   subroutine put_nodal(text, title, set, model, item, global, values, frame)
      type(text_buffer_type), intent(inout) :: text
      character(len=*), intent(in) :: title, set
      type(model_type), intent(in) :: model
      integer, intent(in) :: item(:)
      logical, intent(in) :: global            !! axes; else those of nodes that have some
      real(wp), intent(in) :: values(:, :)     !! (component, item)
      type(frame_type), intent(in) :: frame
      real(wp) :: own(3)
      integer :: i, k, axes

      call put_title(text, title, set, frame)
      do i = 1, size(item)
         axes = 0
         if (.not. global .and. allocated(model%transform%node)) axes = findloc( &
            & model%transform%node, item(i), dim=1)
         own = values(:3, item(i))
         if (axes > 0) own = matmul(model%transform%axes(:, :, axes), own)
         call text%put_integer(model%mesh%node_label(item(i)), 10)
         do k = 1, 3
            call text%put(' ')
            call text%put_exponential(own(k), 6)
         end do
         if (axes > 0) call text%put(' L')
         call text%put_line()
      end do
   end subroutine put_nodal

   subroutine put_table(text, title, set, label, item, values, frame)
      type(text_buffer_type), intent(inout) :: text
      character(len=*), intent(in) :: title, set
      integer, intent(in) :: label(:), item(:)
      real(wp), intent(in) :: values(:, :)     !! (component, item)
      type(frame_type), intent(in) :: frame
      integer :: i, k

      call put_title(text, title, set, frame)
      do i = 1, size(item)
         call text%put_integer(label(item(i)), 10)
         do k = 1, size(values, 1)
            call text%put(' ')
            call text%put_exponential(values(k, item(i)), 6)
         end do
         call text%put_line()
      end do
   end subroutine put_table

   subroutine put_total(text, title, set, values, frame)
      type(text_buffer_type), intent(inout) :: text
      character(len=*), intent(in) :: title, set
      real(wp), intent(in) :: values(:)
      type(frame_type), intent(in) :: frame
      integer :: k

      call put_title(text, title, set, frame)
      call text%put('      ')
      do k = 1, size(values)
         call text%put(' ')
         call text%put_exponential(values(k), 6)
      end do
      call text%put_line()
   end subroutine put_total

   subroutine put_title(text, title, set, frame)
      type(text_buffer_type), intent(inout) :: text
      character(len=*), intent(in) :: title, set
      type(frame_type), intent(in) :: frame
      character(len=14) :: time

      write (time, '(e14.7)') frame%total_time
      call text%put_line()
      call text%put_line(' '//title//' for set '//set//' and time '//time)
      call text%put_line()
   end subroutine put_title
end module lopin_recorder_dat
