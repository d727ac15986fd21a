!> `job.frd`: the fields of *NODE FILE, *EL FILE and *CONTACT FILE in CalculiX's long ASCII format.
module lopin_recorder_frd
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type, output_of
   use lopin_report, only : frame_type
   use lopin_recorder, only : recorder_type, wants_type
   use lopin_safe_text, only : printable
   use lopin_atomic_file, only : log_file_type
   use lopin_text_buffer, only : text_buffer_type
   use lopin_element_points, only : point_tables_type, new_point_tables, nodal_average
   use lopin_recorder_table, only : is_due, frame_asks, has_variable
   use lopin_recorder_dat_contact, only : contact_components
   implicit none
   private
   public :: frd_recorder_type, new_frd_recorder

   type, extends(recorder_type) :: frd_recorder_type
      private
      character(len=:), allocatable :: path
      type(log_file_type) :: log
      type(text_buffer_type) :: text
      type(point_tables_type) :: points
      integer, allocatable :: node(:)      !! nodes of elements, the others are not in the file
      integer :: block = 0                 !! counts blocks
      integer :: frame = 0                 !! counts output times
   contains
      procedure :: begin
      procedure :: commit
      procedure :: increment
      procedure :: close => close_file
      procedure :: keep
      procedure :: wants
   end type frd_recorder_type

   ! By cell id: line2, line3, triangle, triangle6, quad, quad8, tetra, tetra10, wedge, wedge15,
   ! hexahedron, hexahedron20.
   integer, parameter :: frd_number(12) = [11, 12, 7, 8, 9, 10, 3, 6, 2, 5, 1, 4]
   integer, parameter :: wedge_order(15) = [1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 14, 15, 10, 11, 12]
   integer, parameter :: hexahedron_order(20) = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 17, 18, &
      & 19, 20, &
      & 13, 14, 15, 16]
   character(len=*), parameter :: no_text = repeat(' ', 20)

contains

   subroutine new_frd_recorder(self, path)
      type(frd_recorder_type), intent(out) :: self
      character(len=*), intent(in) :: path
      self%path = path
   end subroutine new_frd_recorder

   subroutine begin(self, model, error)
      class(frd_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call new_point_tables(self%points, model)
      self%block = 0
      self%frame = 0
      call self%text%clear()
      call self%text%put_line('    1C')
      call self%text%put_line('    1UPGM               Lopin')
      do i = 1, size(model%material)
         call self%text%put('    1UMAT')
         call self%text%put_integer(i, 5)
         call self%text%put_line(printable(model%material(i)%name))
      end do
      call find_nodes(model, self%node)
      call put_nodes(self%text, model, self%node)
      call put_elements(self%text, self%points, model)
      call self%log%open(self%path, self%text%text(:self%text%n), error, self%resumes)
   end subroutine begin

   subroutine commit(self, error)
      class(frd_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call self%log%commit(error)
   end subroutine commit

   subroutine increment(self, model, frame, error)
      class(frd_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error

      call self%text%clear()
      call put_frame(self, model, frame)
      if (self%text%n > 0) call self%log%append(self%text%text(:self%text%n), error)
   end subroutine increment

   subroutine keep(self, stream, error)
      class(frd_recorder_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error

      call stream%pass(self%block)
      call stream%pass(self%frame)
      call self%log%keep(stream, error)
   end subroutine keep

   subroutine close_file(self, error)
      class(frd_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: also

      call self%log%append(' 9999'//achar(10), error)
      call self%log%close(also)
      if (.not. allocated(error)) call move_alloc(also, error)
   end subroutine close_file

   function wants(self, model, frame) result(what)
      class(frd_recorder_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(wants_type) :: what

      associate (unused => self)
         what%nodal_stress = frame_asks(model, frame, output_of%element_file, ['S   ', 'PEEQ'])
         what%strain = frame_asks(model, frame, output_of%element_file, ['E'])
      end associate
   end function wants

   pure subroutine find_nodes(model, list)
      type(model_type), intent(in) :: model
      integer, allocatable, intent(out) :: list(:)
      logical :: used(0:model%mesh%nnode)
      integer :: e, i

      used = .false.
      do e = 1, model%mesh%nelement
         used(model%mesh%conn(:, e)) = .true.
      end do
      list = pack([(i, i=1, model%mesh%nnode)], used(1:))
   end subroutine find_nodes

   subroutine put_nodes(text, model, node)
      type(text_buffer_type), intent(inout) :: text
      type(model_type), intent(in) :: model
      integer, intent(in) :: node(:)
      real(wp) :: x(3)
      integer :: i, k

      call text%put('    2C')
      call text%put_integer(size(node), 30)
      call text%put_integer(1, 38)
      call text%put_line()
      x = 0.0_wp
      do i = 1, size(node)
         x(:model%mesh%ndim) = model%mesh%x(:, node(i))
         call text%put(' -1')
         call text%put_integer(model%mesh%node_label(node(i)), 10)
         do k = 1, 3
            call text%put_exponential(x(k), 5)
         end do
         call text%put_line()
      end do
      call text%put_line(' -3')
   end subroutine put_nodes

   subroutine put_elements(text, points, model)
      type(text_buffer_type), intent(inout) :: text
      type(point_tables_type), intent(in) :: points
      type(model_type), intent(in) :: model
      integer :: e, k, n, order(20), material

      call text%put('    3C')
      call text%put_integer(model%mesh%nelement, 30)
      call text%put_integer(1, 38)
      call text%put_line()
      do e = 1, model%mesh%nelement
         associate (cell => points%element(model%mesh%etype(e))%cell)
            material = 0
            if (model%mesh%section(e) > 0) material = model%section(model%mesh%section(e))%material
            call text%put(' -1')
            call text%put_integer(model%mesh%element_label(e), 10)
            call text%put_integer(frd_number(cell%id), 5)
            call text%put_integer(0, 5)
            call text%put_integer(material, 5)
            n = cell%nnode
            order = [(k, k=1, 20)]
            if (n == 15) order(:n) = wedge_order
            if (n == 20) order = hexahedron_order
            do k = 1, n
               if (mod(k, 10) == 1) then
                  call text%put_line()
                  call text%put(' -2')
               end if
               call text%put_integer(model%mesh%node_label(model%mesh%conn(order(k), e)), 10)
            end do
            call text%put_line()
         end associate
      end do
      call text%put_line(' -3')
   end subroutine put_elements

   subroutine put_frame(self, model, frame)
      type(frd_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      real(wp), allocatable :: strain(:, :)

      if (due_variable(model, frame, output_of%node_file, ['U'])) then
         call put_vector(self, model, frame, 'DISP', 'D', frame%u)
      end if
      if (due_variable(model, frame, output_of%element_file, ['S']) &
         & .and. allocated(frame%nodal_stress)) then
         call put_tensor(self, model, frame, 'STRESS', 'S', 1.0_wp, frame%nodal_stress)
      end if
      if (due_variable(model, frame, output_of%element_file, ['E']) &
         & .and. allocated(frame%strain)) then
         call nodal_average(self%points, model, frame%first_point, frame%strain, strain)
         call put_tensor(self, model, frame, 'TOSTRAIN', 'E', 0.5_wp, strain)
      end if
      if (due_variable(model, frame, output_of%element_file, ['PEEQ']) &
         & .and. allocated(frame%nodal_plastic)) then
         call put_head(self, frame, size(self%node), 'PE', 1)
         call put_component(self%text, 'PE', 1, 0, 0)
         call put_rows(self%text, model%mesh%node_label, self%node, frame%nodal_plastic)
      end if
      if (due_variable(model, frame, output_of%node_file, ['RF'])) then
         call put_vector(self, model, frame, 'FORC', 'F', frame%rf)
      end if
      if (due_variable(model, frame, output_of%contact_file, [character(len=7) :: 'CDIS', &
         & 'CSTR', 'COPEN', 'CPRESS', 'CSTRESS', 'CDISP'])) call put_contact(self, model, frame)
   end subroutine put_frame

   pure logical function due_variable(model, frame, kind, words)
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: kind
      character(len=*), intent(in) :: words(:)
      integer :: i

      due_variable = .false.
      associate (output => model%step(frame%step)%output)
         do i = 1, size(output)
            if (output(i)%kind /= kind .or. .not. is_due(output(i)%frequency, frame)) cycle
            if (has_variable(output(i)%variable, words)) due_variable = .true.
         end do
      end associate
   end function due_variable

   subroutine put_vector(self, model, frame, name, letter, values)
      type(frd_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      character(len=*), intent(in) :: name, letter
      real(wp), intent(in) :: values(:, :)   !! (>= 3, nnode)
      integer :: k

      call put_head(self, frame, size(self%node), name, 4)
      do k = 1, 3
         call put_component(self%text, letter//to_text(k), 2, k, 0)
      end do
      call self%text%put_line(' -5  ALL         1    2    0    0    1ALL')
      call put_rows(self%text, model%mesh%node_label, self%node, values(:3, :))
   end subroutine put_vector

   !> Components in the order xx yy zz xy yz zx.
   subroutine put_tensor(self, model, frame, name, letter, shear, values)
      type(frd_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      character(len=*), intent(in) :: name, letter
      real(wp), intent(in) :: shear          !! factor on the shears
      real(wp), intent(in) :: values(:, :)   !! (6, nnode) xx yy zz xy xz yz
      character(len=2), parameter :: suffix(6) = ['XX', 'YY', 'ZZ', 'XY', 'YZ', 'ZX']
      integer, parameter :: row(6) = [1, 2, 3, 1, 2, 3], column(6) = [1, 2, 3, 2, 3, 1]
      real(wp), allocatable :: sorted(:, :)
      integer :: k

      call put_head(self, frame, size(self%node), name, 6)
      do k = 1, 6
         call put_component(self%text, letter//suffix(k), 4, row(k), column(k))
      end do
      sorted = values([1, 2, 3, 4, 6, 5], :)
      sorted(4:, :) = shear*sorted(4:, :)
      call put_rows(self%text, model%mesh%node_label, self%node, sorted)
   end subroutine put_tensor

   subroutine put_contact(self, model, frame)
      type(frd_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      character(len=*), parameter :: names(6) = [character(len=7) :: 'COPEN', 'CSLIP1', &
         & 'CSLIP2', 'CPRESS', &
         & 'CSHEAR1', 'CSHEAR2']
      integer, parameter :: row(6) = [1, 2, 3, 1, 2, 3], column(6) = [1, 2, 3, 2, 3, 1]
      real(wp), allocatable :: values(:, :)
      integer, allocatable :: node(:)
      logical, allocatable :: seen(:)
      integer :: p, i, k

      allocate (values(6, model%mesh%nnode), seen(model%mesh%nnode))
      seen = .false.
      do p = 1, size(frame%contact)
         associate (field => frame%contact(p))
            do i = 1, size(field%node)
               if (field%status(i) < 0) cycle
               if (seen(field%node(i))) then
                  if (values(1, field%node(i)) <= field%gap(i)) cycle
               end if
               seen(field%node(i)) = .true.
               values(:, field%node(i)) = contact_components(field, i)
            end do
         end associate
      end do
      node = pack([(i, i=1, size(seen))], seen)
      call put_head(self, frame, size(node), 'CONTACT', 6)
      do k = 1, 6
         call put_component(self%text, trim(names(k)), 4, row(k), column(k))
      end do
      call put_rows(self%text, model%mesh%node_label, node, values)
   end subroutine put_contact

   subroutine put_head(self, frame, n, name, ncomponent)
      type(frd_recorder_type), intent(inout) :: self
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: n             !! nodes
      character(len=*), intent(in) :: name
      integer, intent(in) :: ncomponent
      character(len=12) :: padded

      if (self%text%n == 0) self%frame = self%frame + 1
      self%block = self%block + 1
      call self%text%put('    1PSTEP')
      call self%text%put_integer(self%block, 26)
      call self%text%put_integer(frame%increment, 12)
      call self%text%put_integer(frame%step, 12)
      call self%text%put_line(repeat(' ', 10))
      call self%text%put('  100CL')
      call self%text%put_integer(100 + self%frame, 5)
      call self%text%put_exponential(frame%total_time, 5)
      call self%text%put_integer(n, 12)
      call self%text%put(no_text)
      call self%text%put_integer(0, 2)
      call self%text%put_integer(self%frame, 5)
      call self%text%put_line(repeat(' ', 10)//' 1')
      padded = name
      call self%text%put(' -4  '//padded(:8))
      call self%text%put_integer(ncomponent, 5)
      call self%text%put_line('    1')
   end subroutine put_head

   subroutine put_component(text, name, kind, first, second)
      type(text_buffer_type), intent(inout) :: text
      character(len=*), intent(in) :: name
      integer, intent(in) :: kind           !! 2: vector, 4: tensor
      integer, intent(in) :: first, second
      character(len=8) :: padded

      padded = name
      call text%put(' -5  '//padded)
      call text%put_integer(1, 5)
      call text%put_integer(kind, 5)
      call text%put_integer(first, 5)
      call text%put_integer(second, 5)
      call text%put_line()
   end subroutine put_component

   subroutine put_rows(text, label, node, values)
      type(text_buffer_type), intent(inout) :: text
      integer, intent(in) :: label(:), node(:)
      real(wp), intent(in) :: values(:, :)
      integer :: i, k

      do i = 1, size(node)
         call text%put(' -1')
         call text%put_integer(label(node(i)), 10)
         do k = 1, size(values, 1)
            call text%put_exponential(values(k, node(i)), 5)
         end do
         call text%put_line()
      end do
      call text%put_line(' -3')
   end subroutine put_rows
end module lopin_recorder_frd
