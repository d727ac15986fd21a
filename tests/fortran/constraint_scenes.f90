!> Small decks for tests of dofs, constraints, bodies and rows: squares, cubes, rigid bodies.
module constraint_scenes
   use lopin_error, only : error_type, log_type
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_model, only : model_type
   use lopin_build_model, only : new_model
   implicit none
   private
   public :: model_of, squares, cube, ended, nl

   character(len=1), parameter :: nl = achar(10)
   character(len=*), parameter :: steel = '*MATERIAL, NAME=M'//nl//'*ELASTIC'//nl//'1000., 0.3'//nl
   character(len=*), parameter :: ended = '*STEP'//nl//'*STATIC'//nl//'*END STEP'//nl

contains

   !> Two unit squares of a family, LOW at the origin and UP above a gap of 0.1; node REF (9) at (3,
   !> 2).
   function squares(family) result(text)
      character(len=*), intent(in) :: family
      character(len=:), allocatable :: text
      text = '*NODE, NSET=ALL'//nl//'1, 0., 0.'//nl//'2, 1., 0.'//nl//'3, 1., 1.'//nl// &
         & '4, 0., 1.'//nl &
         & //'5, 0., 1.1'//nl//'6, 1., 1.1'//nl//'7, 1., 2.1'//nl//'8, 0., 2.1'//nl &
         & //'*NODE, NSET=REF'//nl//'9, 3., 2.'//nl//'*NODE'//nl//'10, 5., 5.'//nl &
         & //'*ELEMENT, TYPE='//family//', ELSET=LOW'//nl//'1, 1, 2, 3, 4'//nl &
         & //'*ELEMENT, TYPE='//family//', ELSET=UP'//nl//'2, 5, 6, 7, 8'//nl//steel &
         & //'*SOLID SECTION, ELSET=LOW, MATERIAL=M'//nl//'*SOLID SECTION, ELSET=UP, MATERIAL=M'// &
         & nl &
         & //'*NSET, NSET=TOP'//nl//'7, 8'//nl//'*NSET, NSET=BOTTOM'//nl//'1, 2'//nl &
         & //'*SURFACE, NAME=SLAVE'//nl//'UP, S1'//nl//'*SURFACE, NAME=MASTER'//nl//'LOW, S3'//nl
   end function squares

   !> A unit cube; node REF (9) at (2, -1, 3).
   function cube() result(text)
      character(len=:), allocatable :: text
      text = '*NODE, NSET=ALL'//nl//'1, 0., 0., 0.'//nl//'2, 1., 0., 0.'//nl//'3, 1., 1., 0.'//nl &
         & //'4, 0., 1., 0.'//nl//'5, 0., 0., 1.'//nl//'6, 1., 0., 1.'//nl//'7, 1., 1., 1.'//nl &
         & //'8, 0., 1., 1.'//nl//'*NODE, NSET=REF'//nl//'9, 2., -1., 3.'//nl &
         & //'*ELEMENT, TYPE=C3D8, ELSET=BOX'//nl//'1, 1, 2, 3, 4, 5, 6, 7, 8'//nl//steel &
         & //'*SOLID SECTION, ELSET=BOX, MATERIAL=M'//nl//'*NSET, NSET=TOP'//nl//'5, 6, 7, 8'//nl
   end function cube

   subroutine model_of(text, model, error)
      character(len=*), intent(in) :: text
      type(model_type), intent(out) :: model
      type(error_type), allocatable, intent(out) :: error
      type(deck_type) :: deck
      type(log_type) :: log

      call read_deck_text(deck, text, 'deck.inp', '', log, error)
      if (.not. allocated(error)) call new_model(model, deck, error)
   end subroutine model_of
end module constraint_scenes
