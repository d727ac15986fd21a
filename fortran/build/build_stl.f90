!> Rigid tools from files of triangles: `*SURFACE, TYPE=STL, INPUT=file`.
module lopin_build_stl
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, severity, location_type
   use lopin_text, only : to_text, parse_real, upper
   use lopin_facet_mesh, only : facet_flaws_type
   use lopin_tool_factory, only : new_tool_from_facets
   use lopin_model, only : model_type, tool_holder_type
   use lopin_block, only : deck_type, block_type, get_parameter, has_parameter, complain
   use lopin_build_scene, only : scene_type
   use lopin_build_parts, only : placed
   use lopin_source, only : find_include
   use lopin_stl_reader, only : read_stl
   implicit none
   private
   public :: build_stl_tool

   !> What a file of triangles says.
   type :: stl_file_type
      character(len=:), allocatable :: path
      type(location_type) :: at                      !! of its name in the deck
      real(wp), allocatable :: corner(:, :, :)       !! (3, 3, n) [length]
      integer :: contrary = 0                        !! triangles whose normal looks inward
   end type stl_file_type

contains

   subroutine build_stl_tool(k, model, deck, scene, block, scope, name)
      integer, intent(out) :: k                      !! index of the tool; 0 after a complaint
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      character(len=*), intent(in) :: name
      type(tool_holder_type) :: holder
      type(facet_flaws_type) :: flaws
      type(error_type), allocatable :: error
      type(stl_file_type) :: file
      type(location_type) :: at
      character(len=:), allocatable :: word
      logical :: curved, found

      k = 0
      call read_corners(file, model, deck, scene, block, scope)
      if (.not. allocated(file%corner)) return
      curved = .true.
      call get_parameter(block, 'SMOOTH', word, at, found)
      if (found) curved = upper(word) /= 'NO'
      call new_tool_from_facets(holder%shape, file%corner, has_parameter(block, 'OPEN'), &
         & has_parameter(block, 'REPAIR'), flaws, error, curved)
      if (allocated(error)) then
         call complain(model%log, error%item(1)%id, file%path//': '//error%item(1)%message, &
            & file%at, help=error%item(1)%help)
         return
      end if
      call tell(model, file%path, flaws, file%contrary, file%at)
      if (model%mesh%ndim /= 3) then
         call complain(model%log, 'E0314', 'TYPE=STL makes a tool of 3 dimensions; the mesh '// &
            & 'has 2', file%at, help='TYPE=SEGMENTS in two dimensions')
         return
      end if
      holder%name = name
      model%tool = [model%tool, holder]
      k = size(model%tool)
   end subroutine build_stl_tool

   !> Scaled first, then moved with the instance of the part.
   subroutine read_corners(self, model, deck, scene, block, scope)
      type(stl_file_type), intent(out) :: self       !! without corners after a complaint
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      character(len=:), allocatable :: file, text, tried, reason
      type(location_type) :: scale_at
      real(wp) :: scale
      logical :: found, ok
      integer :: i, j

      scale = 1.0_wp
      self%path = ''
      call get_parameter(block, 'SCALE', text, scale_at, found)
      if (found) call parse_real(text, scale, ok)
      if (.not. scale > 0.0_wp) then
         call complain(model%log, 'E0106', 'SCALE='//text//' must be positive', scale_at)
         return
      end if
      call get_parameter(block, 'INPUT', file, self%at, found)
      if (.not. found .or. len(file) == 0) then
         call complain(model%log, 'E0331', 'TYPE=STL needs INPUT=, the file of the triangles', &
            & block%at)
         return
      end if
      call find_include(deck%source, block%at%file, file, self%path, tried)
      if (self%path == '') then
         call complain(model%log, 'E0331', 'the file `'//file//'` is not there', self%at, &
            & note='looked for '//tried)
         return
      end if
      call read_stl(self%path, self%corner, self%contrary, reason)
      if (reason /= '') then
         call complain(model%log, 'E0331', self%path//' is not an STL file that can be used: '// &
            & reason, self%at)
         deallocate (self%corner)
         return
      end if
      do j = 1, size(self%corner, 3)
         call model%outside%add(self%corner(:, :, j))
         do i = 1, 3
            self%corner(:, i, j) = placed(scene, scope, scale*self%corner(:, i, j))
         end do
      end do
   end subroutine read_corners

   subroutine tell(model, path, flaws, contrary, at)
      type(model_type), intent(inout) :: model
      character(len=*), intent(in) :: path
      type(facet_flaws_type), intent(in) :: flaws
      integer, intent(in) :: contrary
      type(location_type), intent(in) :: at

      if (flaws%degenerate > 0) call model%log%say(severity%note, 'N0331', path//': '// &
         & to_text(flaws%degenerate)//' facets without area were dropped', at)
      if (flaws%against > 0) call model%log%say(severity%note, 'N0331', path//': '// &
         & to_text(flaws%against)//' facets were turned to the side of the others', at)
      if (contrary > 0) call model%log%say(severity%warning, 'W0331', path//': the normals of '// &
         & to_text(contrary)//' facets look against the order of their corners', at, &
         & help='the order of the corners is what counts: look at the tool before you trust it')
   end subroutine tell
end module lopin_build_stl
